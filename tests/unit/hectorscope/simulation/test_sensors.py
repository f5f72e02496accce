"""What the sensors report of a motion."""

from dataclasses import replace

import numpy as np
import pytest

from hectorscope.simulation import ScenarioName, SceneOptions, Simulation, sensors
from hectorscope.simulation.motion import Motion
from hectorscope.simulation.scene import Scene
from hectorscope.simulation.worlds import Surface, World, box
from slam_core.geometry import from_euler
from slam_core.measurements import Imu, LaserScan, Transform


def still_in_a_hall(half: float = 6.0, depth: float = 0.0) -> Scene:
    """A laser that does not move in the middle of a square hall."""
    motion = Motion.through(lambda t: np.zeros((len(t), 6)), 5.0)
    hall = Surface(box(-half, -half, half, half, -1, 2), depth)
    return Scene(World([hall]), motion, Transform())


def scans(scene: Scene, options: SceneOptions) -> list[LaserScan]:
    return [scan for _, scan in sensors.laser_scans(scene, options) if isinstance(scan, LaserScan)]


def distance_to_triangles(point: np.ndarray, triangles: np.ndarray) -> float:
    """Shortest distance to a soup of triangles, by projection and barycentric coordinates."""
    a, u, v = triangles[:, 0], triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    normal = np.cross(u, v)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    offset = point - a
    height = np.abs(np.einsum("ni,ni->n", offset, normal))
    uu, vv, uv = (u * u).sum(1), (v * v).sum(1), (u * v).sum(1)
    ou, ov = (offset * u).sum(1), (offset * v).sum(1)
    det = uu * vv - uv * uv
    s, t = (vv * ou - uv * ov) / det, (uu * ov - uv * ou) / det
    inside = (s > -1e-3) & (t > -1e-3) & (s + t < 1 + 1e-3)
    return float(height[inside].min(initial=np.inf))


@pytest.mark.parametrize("scenario", ["arena", "littoral", "handheld"])
def test_each_beam_ends_on_the_world(scenario: ScenarioName) -> None:
    """Without noise, every endpoint placed by the truth at its own beam's time lies on a surface."""
    simulation = Simulation(scenario, SceneOptions(duration=14.0, scan_rate=1.0, beams=91, noise=0.0))
    world, mount = simulation.scene.world, simulation.scene.T_base_laser
    checked = 0
    for scan in scans(simulation.scene, simulation.options)[8:]:
        for i in np.flatnonzero(np.isfinite(scan.ranges)):
            time_ns = scan.stamp_ns + round(i * scan.time_increment * 1e9)
            seconds = np.array([(time_ns - sensors.START_NS) * 1e-9])
            position, attitude = (value[0] for value in simulation.scene.motion.poses(seconds))
            angle = scan.angle_min + i * scan.angle_increment
            beam = scan.ranges[i] * np.array([np.cos(angle), np.sin(angle), 0.0])
            point = position + attitude @ (mount.translation + beam)
            levels = (abs(point[2] - world.ground), abs(point[2] - world.ceiling))
            assert min(*levels, distance_to_triangles(point, world.triangles)) < 2e-5
            checked += 1
    assert checked > 200


def test_the_sweep_takes_its_time() -> None:
    """270 of 360 degrees of a turn at 40 Hz: the last of 1081 beams leaves 18.75 ms after the first."""
    scan = scans(still_in_a_hall(), SceneOptions())[4]
    assert scan.stamp_ns == sensors.START_NS + 100_000_000
    assert scan.time_increment == pytest.approx(25e-3 * 0.25 / 360)
    assert scan.end_ns - scan.stamp_ns == pytest.approx(18_750_000, abs=2)
    assert scan.angle_min == pytest.approx(np.radians(-135))
    assert scan.angle_increment == pytest.approx(np.radians(0.25))


def test_beam_timing_can_be_switched_off() -> None:
    """Then a turning laser sees all beams from one pose: the pattern of a still one, turned."""
    options = SceneOptions(noise=0.0, beam_timing=False, scan_rate=2.0, beams=271)
    turning = replace(still_in_a_hall(), motion=Motion.through(lambda t: np.outer(t, [0, 0, 0, 0, 0, np.pi]), 5.0))
    moved, still = scans(turning, options), scans(still_in_a_hall(), options)
    assert moved[1].time_increment == 0.0
    np.testing.assert_allclose(moved[1].ranges, still[0].ranges, rtol=1e-6)  # a quarter turn in a square hall
    smeared = scans(turning, replace(options, beam_timing=True))[1]
    assert np.abs(smeared.ranges - still[0].ranges).max() > 0.1


def test_a_mount_turns_the_scan() -> None:
    """A laser that hangs upside down sees the same hall mirrored."""
    options = SceneOptions(noise=0.0, beams=271)
    scene = still_in_a_hall()
    scene.world.surfaces[0].triangles[:, :, 1] += 2.0  # left and right differ
    upright = scans(scene, options)[0]
    hanging = scans(replace(scene, T_base_laser=Transform(rotation=from_euler(np.pi, 0.0, 0.0))), options)[0]
    np.testing.assert_allclose(hanging.ranges, upright.ranges[::-1], rtol=1e-6)


def test_noise_of_the_laser() -> None:
    """1 cm up to 10 m, more beyond, in whole millimetres, with a few drop-outs that read +inf."""
    for half, expected in ((5.0, 0.010), (17.0, 0.010 + 0.001 * 7)):
        scene = still_in_a_hall(half)
        ahead = slice(520, 561)  # beams that meet the wall ahead almost squarely
        ranges = np.array([scan.ranges for scan in scans(scene, SceneOptions())], dtype=np.float64)
        exact = scans(scene, SceneOptions(noise=0.0))[0].ranges[ahead]
        lost = ~np.isfinite(ranges)
        assert 0.002 < lost.mean() < 0.004
        assert np.all(ranges[lost] == np.inf)
        errors = np.where(lost, np.nan, ranges)[:, ahead] - exact
        assert np.nanstd(errors) == pytest.approx(expected, rel=0.05)
        assert abs(np.nanmean(errors)) < 5e-4
        seen = ranges[~lost]
        np.testing.assert_allclose(seen, np.round(seen, 3), atol=2e-6)


def test_foliage_returns_late() -> None:
    """Beams enter a bush before they return, never the other way round."""
    ranges = np.array([scan.ranges for scan in scans(still_in_a_hall(3.0, depth=0.2), SceneOptions())])
    behind = ranges[np.isfinite(ranges[:, 540]), 540] - 3.0
    assert behind.mean() == pytest.approx(0.2 * np.sqrt(2 / np.pi), rel=0.2)
    assert behind.min() > -0.04


def test_too_close_and_too_far() -> None:
    """REP-117: nearer than range_min reads -inf, nothing within range_max reads +inf."""
    assert np.all(scans(still_in_a_hall(0.05), SceneOptions(noise=0.0))[0].ranges[540] == -np.inf)
    assert np.all(scans(still_in_a_hall(31.0), SceneOptions(noise=0.0))[0].ranges[540] == np.inf)


def test_errors_of_the_inertial_unit() -> None:
    """At rest: white noise of the stated size around a constant bias within its bounds."""
    scene = replace(still_in_a_hall(), motion=Motion.through(lambda t: np.zeros((len(t), 6)), 60.0))
    biases = []
    for seed in range(8):
        samples = [
            imu for _, imu in sensors.inertial(scene.motion, SceneOptions(seed=seed)) if isinstance(imu, Imu)
        ]
        gyro = np.array([imu.angular_velocity for imu in samples])
        accel = np.array([imu.linear_acceleration for imu in samples]) - [0.0, 0.0, 9.80665]
        np.testing.assert_allclose(gyro.std(axis=0), 0.005, rtol=0.05)
        np.testing.assert_allclose(accel.std(axis=0), 0.03, rtol=0.05)
        biases.append(np.concatenate((gyro.mean(axis=0), accel.mean(axis=0))))
    largest = np.abs(biases).reshape(8, 2, 3).max(axis=(0, 2))
    assert np.all(largest < np.array([np.radians(0.5), 0.05]) * 1.1)
    assert np.all(largest > np.array([np.radians(0.5), 0.05]) * 0.7)


def test_noise_zero_measures_exactly() -> None:
    """Rates, forces and heights are then those of the motion."""
    simulation = Simulation("handheld", SceneOptions(duration=5.0, noise=0.0))
    motion = simulation.scene.motion
    t = np.arange(501) / 100
    imus = [imu for _, imu in sensors.inertial(motion, simulation.options) if isinstance(imu, Imu)]
    np.testing.assert_array_equal([imu.angular_velocity for imu in imus], motion.body_rates(t))
    np.testing.assert_array_equal([imu.linear_acceleration for imu in imus], motion.specific_force(t))
