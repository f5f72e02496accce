"""Whole scenarios: what they contain, that they repeat, and that they are the scenes they claim to be."""

from dataclasses import replace

import numpy as np
import pytest

from hectorscope.simulation import ScenarioName, SceneOptions, Simulation, SimulationError, sensors
from slam_core.measurements import GpsPosition, GpsVelocity, Height, Imu, LaserScan, MagneticField, TruthPose

DEMOS: tuple[ScenarioName, ...] = ("arena", "littoral", "handheld")
SHORT = SceneOptions(duration=4.0, beams=181)


def fingerprint(simulation: Simulation) -> bytes:
    """Every number of every item."""
    parts = []
    for arrival_ns, item in simulation.arrivals():
        values: list[object] = [arrival_ns, item.stamp_ns]
        if isinstance(item, LaserScan):
            values += [item.ranges.tobytes(), item.time_increment]
        elif isinstance(item, Imu):
            values += [item.angular_velocity.tobytes(), item.linear_acceleration.tobytes()]
        elif isinstance(item, Height):
            values.append(item.height)
        elif isinstance(item, MagneticField):
            values.append(item.field.tobytes())
        elif isinstance(item, GpsPosition):
            values.append(item.position.tobytes())
        elif isinstance(item, GpsVelocity):
            values.append(item.velocity.tobytes())
        else:
            values += [item.T_map_base.translation.tobytes(), item.T_map_base.rotation.tobytes()]
        parts.append(repr(values))
    return "\n".join(parts).encode()


@pytest.mark.parametrize("scenario", [*DEMOS, "people", "glass", "offices"])
def test_same_seed_same_numbers(scenario: ScenarioName) -> None:
    """A simulation gives the same again, a new one of the same seed too, another seed does not."""
    simulation = Simulation(scenario, SHORT)
    first = fingerprint(simulation)
    assert fingerprint(simulation) == first
    assert fingerprint(Simulation(scenario, SHORT)) == first
    assert fingerprint(Simulation(scenario, replace(SHORT, seed=2))) != first


def test_items_come_in_order_of_arrival_at_their_rates() -> None:
    """40 scans, 100 inertial samples, 10 heights, 100 true poses a second; a scan arrives after its last beam."""
    simulation = Simulation("rooms", SHORT)
    arrivals = list(simulation.arrivals())
    times = [arrival_ns for arrival_ns, _ in arrivals]
    assert times == sorted(times)
    assert [item for _, item in arrivals if isinstance(item, TruthPose)]
    count = {
        kind: sum(isinstance(item, kind) for _, item in arrivals) for kind in (LaserScan, Imu, Height, TruthPose)
    }
    assert count == {LaserScan: 160, Imu: 401, Height: 41, TruthPose: 401}
    for arrival_ns, item in arrivals:
        done = item.end_ns if isinstance(item, LaserScan) else item.stamp_ns
        assert 0 <= arrival_ns - done < 5_000_000
    assert len(list(simulation.items())) == len(arrivals)


def test_without_an_inertial_unit() -> None:
    """Nothing inertial is left, and the scans stay the same."""
    bare = list(Simulation("rooms", replace(SHORT, imu=False)).items())
    assert not any(isinstance(item, Imu) for item in bare)
    whole = [item for item in Simulation("rooms", SHORT).items() if isinstance(item, LaserScan)]
    scans = [item for item in bare if isinstance(item, LaserScan)]
    assert all(np.array_equal(a.ranges, b.ranges) for a, b in zip(whole, scans, strict=True))


def test_truth_at_any_time() -> None:
    """The true poses that are handed out lie on `truth_at`."""
    simulation = Simulation("handheld", SHORT)
    for item in simulation.items():
        if isinstance(item, TruthPose):
            T = simulation.truth_at(item.stamp_ns)
            np.testing.assert_allclose(T.translation, item.T_map_base.translation, atol=1e-8)
            np.testing.assert_allclose(T.rotation, item.T_map_base.rotation, atol=1e-8)


@pytest.mark.parametrize(
    ("scenario", "seconds", "tilt", "speed", "height"),
    [
        ("arena", 60.0, (14.5, 15.2), (0.5, 0.65), 0.32),
        ("littoral", 58.0, (7.0, 8.0), (1.2, 1.6), 0.19),
        ("handheld", 59.0, (9.0, 10.0), (1.1, 1.4), 0.018),
        ("rooms", 60.0, (0.0, 0.0), (1.3, 1.4), 0.0),
        ("corridor", 90.0, (0.0, 0.0), (0.95, 1.05), 0.0),
        ("people", 60.0, (0.0, 0.0), (0.75, 0.85), 0.0),
        ("glass", 60.0, (0.0, 0.0), (0.75, 0.85), 0.0),
        ("offices", 1200.0, (0.0, 0.0), (0.55, 0.65), 0.0),
    ],
)
def test_scenes_move_as_they_should(
    scenario: ScenarioName,
    seconds: float,
    tilt: tuple[float, float],
    speed: tuple[float, float],
    height: float,
) -> None:
    """Start at the origin, heading along x, nearly still for 2 s; then the scene's tilt, speed and height."""
    motion = Simulation(scenario).scene.motion
    assert motion.duration == seconds
    t = np.arange(0.0, seconds, 0.02)
    pose, rate = motion.at(t), motion.at(t, 1)
    np.testing.assert_allclose(pose[0], 0.0, atol=1e-3)
    assert np.abs(pose[t < 2.0]).max() < 0.02
    assert np.linalg.norm(motion.body_rates(t[t < 2.0]), axis=1).max() < 0.03
    largest = np.degrees(np.abs(pose[:, 3:5]).max())
    assert tilt[0] <= largest <= tilt[1]
    assert speed[0] < np.hypot(rate[:, 0], rate[:, 1]).max() < speed[1]
    assert np.abs(pose[:, 2]).max() == pytest.approx(height, abs=0.01)


@pytest.mark.parametrize("scenario", ["arena", "littoral", "handheld"])
def test_demos_come_back_to_where_they_began(scenario: ScenarioName) -> None:
    """The loop closes before the recording ends."""
    simulation = Simulation(scenario)
    t = np.arange(20.0, simulation.duration, 0.1)
    away = np.hypot(*simulation.scene.motion.at(t)[:, :2].T)
    assert away.max() > 8.0
    assert away[-50:].min() < 3.0


@pytest.mark.parametrize("scenario", [*DEMOS, "rooms", "corridor", "people", "glass", "offices"])
def test_nothing_is_driven_through(scenario: ScenarioName) -> None:
    """All along the way there is room around the laser, at its height."""
    scene = Simulation(scenario, SceneOptions(duration=500.0) if scenario == "offices" else None).scene
    angles = np.linspace(0.0, 2 * np.pi, 72)
    around = np.column_stack((np.cos(angles), np.sin(angles), np.zeros(72)))
    up = scene.T_base_laser.translation * [0.0, 0.0, 1.0]
    for t in np.arange(0.0, scene.motion.duration, 0.5):
        position = scene.motion.transform(t).translation + up
        clearance, _ = scene.world.cast(np.tile(position, (72, 1)), around, 30.0)
        assert clearance.min() > 0.3, (scenario, t, position)


def test_a_corridor_does_not_say_how_far_along_it_one_is() -> None:
    """In the middle no end is in sight: the sweep stays the same a metre further on, but not to the side."""
    scene = Simulation("corridor").scene
    angles = np.linspace(-0.75 * np.pi, 0.75 * np.pi, 271)
    beams = np.column_stack((np.cos(angles), np.sin(angles), np.zeros(271)))

    def sweep(x: float, y: float) -> np.ndarray:
        return scene.world.cast(np.tile([x, y, 0.25], (271, 1)), beams, 30.0)[0]

    np.testing.assert_allclose(sweep(51.0, 0.0), sweep(50.0, 0.0), atol=1e-6)
    assert np.isfinite(sweep(90.0, 0.0)).all()
    assert not np.isfinite(sweep(50.0, 0.0)).all()
    right, left = sweep(50.0, 0.0)[[45, 225]]
    assert (left + right, left - right) == (pytest.approx(2.4), pytest.approx(1.0))


def test_water_swallows_beams_and_the_shore_returns_them() -> None:
    """Afloat, a part of every sweep returns and a part does not."""
    simulation = Simulation("littoral", SceneOptions(scan_rate=1.0))
    shares = [np.isfinite(s.ranges).mean() for s in simulation.items() if isinstance(s, LaserScan)]
    assert min(shares) > 0.2
    assert max(shares) < 0.97


def test_sway_is_an_option() -> None:
    """A swaying drive reaches the roll and pitch that were asked for, at the frequency asked for."""
    options = SceneOptions(sway=15.0, sway_frequency=1.0, duration=20.0)
    angles = np.degrees(Simulation("rooms", options).scene.motion.at(np.arange(0.0, 20.0, 0.01))[:, 3:5])
    np.testing.assert_allclose(np.abs(angles).max(axis=0), 15.0, atol=0.5)
    crossings = np.count_nonzero(np.diff(np.sign(angles[1000:, 0])))
    assert crossings == pytest.approx(2 * 10, abs=1)


def test_speed_and_rate_are_options() -> None:
    """Twice the speed goes about twice as far; 10 Hz gives a quarter of the scans, each four times as long."""
    slow, fast = (Simulation("rooms", SceneOptions(duration=12.0, speed=s, scan_rate=10.0)) for s in (0.5, 1.0))
    t = np.arange(0.0, 12.0, 0.01)
    lengths = [np.hypot(*np.diff(s.scene.motion.at(t)[:, :2], axis=0).T).sum() for s in (slow, fast)]
    assert lengths[1] / lengths[0] == pytest.approx(2.0, rel=0.15)
    scans = [item for item in slow.items() if isinstance(item, LaserScan)]
    assert len(scans) == 120
    assert scans[0].end_ns - scans[0].stamp_ns == pytest.approx(75_000_000, abs=2)


@pytest.mark.parametrize(
    ("option", "value", "words"),
    [
        ("duration", 1.0, "duration is 1 s: give 3"),
        ("beams", 1, "beams is 1: give 2"),
        ("noise", -1.0, "noise is -1"),
    ],
)
def test_options_out_of_range(option: str, value: float, words: str) -> None:
    """The message names the option, the value and the range."""
    with pytest.raises(SimulationError, match=words):
        SceneOptions(**{option: value})


def test_stamps_start_at_the_same_clock() -> None:
    """All recordings begin at one fixed time, so that they are the same whenever they are made."""
    first = next(iter(Simulation("rooms", SHORT).items()))
    assert first.stamp_ns == sensors.START_NS


def test_a_recording_may_begin_in_motion() -> None:
    """It is the rest of the same drive: its first true pose is that of the whole drive at that time."""
    whole = Simulation("rooms", replace(SHORT, duration=10.0))
    late = Simulation("rooms", replace(SHORT, duration=10.0, begin=6.0))
    assert late.duration == pytest.approx(4.0)
    begin_ns = sensors.nanoseconds(6.0)
    there, here = whole.truth_at(begin_ns), late.truth_at(sensors.START_NS)
    np.testing.assert_allclose(here.translation, there.translation, atol=1e-9)
    speed = np.hypot(*late.scene.motion.at(np.zeros(1), 1)[0, :2])
    assert speed > 1.0
    heights = [item.height for item in late.items() if isinstance(item, Height)]
    assert abs(np.mean(heights[:5])) < 0.3


def test_a_drive_has_to_go_on_after_the_begin() -> None:
    """A begin too near to the end is refused with both times."""
    with pytest.raises(SimulationError, match=r"begin is 3 s, and the drive ends after 4 s"):
        Simulation("rooms", replace(SHORT, begin=3.0))
