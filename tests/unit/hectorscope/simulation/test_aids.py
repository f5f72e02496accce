"""What magnetometer, satellite receiver and rangefinder report of a motion."""

from typing import Any

import numpy as np
import pytest

from hectorscope.simulation import SceneOptions, Simulation, aids
from slam_core import geometry
from slam_core.measurements import GpsPosition, GpsVelocity, GroundDistance, MagneticField

ALL: dict[str, Any] = {
    "extras": ("gps", "compass", "rangefinder"),
    "duration": 12.0,
    "beams": 11,
    "scan_rate": 1.0,
}


def measured(kind: type, scenario: Any = "littoral", **options: Any) -> list[Any]:
    """Everything of one kind, and the simulation in front."""
    simulation = Simulation(scenario, SceneOptions(**{**ALL, **options}))
    return [simulation, *(item for item in simulation.items() if isinstance(item, kind))]


def test_a_field_without_noise_is_the_same_in_the_world_wherever_the_base_turns() -> None:
    """Turned by the true attitude and by the map's own turn it points to magnetic north and down."""
    simulation, *fields = measured(MagneticField, noise=0.0)
    for item in fields:
        in_map = geometry.rotate(simulation.truth_at(item.stamp_ns).rotation, item.field)
        east, north, up = geometry.rotate(geometry.yaw_quaternion(aids.MAP_YAW), in_map)
        assert np.arctan2(east, north) == pytest.approx(aids.DECLINATION)
        np.testing.assert_allclose([np.hypot(east, north), -up], [aids.HORIZONTAL, aids.VERTICAL])


def test_metal_disturbs_for_a_tenth_of_the_drive() -> None:
    """There the size changes by a tenth and more, elsewhere by a few percent."""
    simulation, *fields = measured(MagneticField, duration=40.0)
    seconds = np.array([item.stamp_ns - fields[0].stamp_ns for item in fields]) * 1e-9
    sizes = np.array([np.linalg.norm(item.field) for item in fields])
    usual = np.hypot(aids.HORIZONTAL, aids.VERTICAL)
    changed = np.abs(sizes / usual - 1.0)
    begin, lasts = 0.3 * simulation.duration, 0.1 * simulation.duration
    near = (seconds > begin) & (seconds < begin + lasts)
    assert changed[near].max() > 0.1
    assert changed[~near].max() < 0.05


def test_fixes_are_those_of_the_antenna_and_pause_in_the_middle() -> None:
    """Without noise position and velocity are the truth's in the turned plane; none come during the outage."""
    simulation, *fixes = measured(GpsPosition, noise=0.0, gps_outage=4.0)
    for fix in fixes:
        T = simulation.truth_at(fix.stamp_ns)
        in_map = T.translation + geometry.rotate(T.rotation, fix.antenna)
        wanted = geometry.rotate(geometry.yaw_quaternion(aids.MAP_YAW), in_map)
        np.testing.assert_allclose(fix.position, wanted, atol=1e-7)
    stamps = np.array([fix.stamp_ns for fix in fixes])
    assert np.diff(stamps).max() == 4_000_000_000
    _, *velocities = measured(GpsVelocity, noise=0.0, gps_outage=4.0)
    assert [velocity.stamp_ns for velocity in velocities] == stamps.tolist()
    assert max(np.linalg.norm(velocity.velocity) for velocity in velocities) > 1.0


def test_a_receiver_is_wrong_in_the_same_way_for_a_while() -> None:
    """Errors of about a metre that differ little from one fix to the next."""
    (_, *noisy), (_, *exact) = (
        measured(GpsPosition, gps_outage=0.0),
        measured(GpsPosition, noise=0.0, gps_outage=0.0),
    )
    errors = np.array([a.position - b.position for a, b in zip(noisy, exact, strict=True)])
    assert 0.2 < np.abs(errors[:, :2]).mean() < 3.0
    assert np.abs(np.diff(errors, axis=0)).mean() < 0.3


def test_a_rangefinder_measures_the_water_under_a_boat() -> None:
    """Its beam, placed by the truth, ends on the water within its noise."""
    simulation, *beams = measured(GroundDistance)
    ends = []
    for beam in beams:
        T = simulation.truth_at(beam.stamp_ns)
        ends.append((T.translation + geometry.rotate(T.rotation, beam.origin + beam.distance * beam.direction))[2])
    assert len(beams) > 200
    assert 0.005 < np.std(ends) < 0.015
    assert abs(np.mean(ends)) < 0.005


def test_what_is_not_carried_is_not_measured() -> None:
    """A scene has its own taste, and options overrule it."""
    assert Simulation("littoral").extras == ("gps", "compass")
    assert Simulation("arena").extras == ()
    kinds = (MagneticField, GpsPosition, GpsVelocity, GroundDistance)
    simulation = Simulation("littoral", SceneOptions(duration=3.0, beams=11, extras=()))
    assert not any(isinstance(item, kinds) for item in simulation.items())
