"""Section IV: endpoints through mount, attitude and motion, and which beams count."""

import math

import numpy as np
import pytest

from slam_core import geometry
from slam_core.config import ScanConfig
from slam_core.measurements import LaserScan, Transform
from slam_core.scan.stabilise import stabilise
from tests.worlds import standing

OPEN = ScanConfig(range_min=0.0, range_max=100.0, z_min=-10.0, z_max=10.0)


def at_each(motion):
    """A motion of one instant, asked for several."""

    def poses(from_ns, since_ns):
        transforms = [motion(from_ns + time_ns) for time_ns in since_ns.tolist()]
        return np.array([[*T.rotation, *T.translation] for T in transforms])

    return poses


def scan(ranges, *, increment=math.pi / 2, start=0.0, **kwargs):
    """A scan with these ranges at quarter turns."""
    return LaserScan(1_000_000_000, np.array(ranges, np.float32), start, increment, range_max=50.0, **kwargs)


def test_a_level_scan_keeps_its_shape():
    """Without motion, mount and tilt the endpoints are the polar ones."""
    points = stabilise(scan([1.0, 2.0, 3.0, 4.0]), standing, OPEN).points
    np.testing.assert_allclose(points, [[1, 0], [0, 2], [-3, 0], [0, -4]], atol=1e-5)


@pytest.mark.parametrize("far", [math.nan, math.inf, -1e30, 2e4])
def test_a_laser_that_cannot_sit_there_has_no_beam(far):
    """Its ends would lie in cells whose number cannot be told."""
    mounted = scan([1.0, 2.0], T_base_laser=Transform(np.array([0.0, far, 0.0])))
    assert len(stabilise(mounted, standing, OPEN).points) == 0


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 0.0, 0.39, 50.0, 60.0, -1.0])
def test_rep_117_values_and_ranges_out_of_bounds_are_left_out(bad):
    """NaN, both infinities, zero, too close and too far never become endpoints."""
    got = stabilise(scan([1.0, bad, 3.0, 4.0]), standing, ScanConfig(range_min=0.4, range_max=50.0))
    assert len(got.points) == 3
    assert len(got.cleared) == 0


def test_what_is_sent_where_nothing_returns_is_no_wall():
    """The end of the range with 3 cm of noise, cut off there or not: 10 cm before it the endpoints end."""
    sent = 50.0 + 0.03 * np.random.default_rng(1).standard_normal(200)
    for each in (sent, np.minimum(sent, 50.0)):
        assert len(stabilise(scan([49.8, *each]), standing, OPEN).points) == 1


def test_walls_up_to_the_end_of_the_range_are_seen():
    """Few are before the end of a laser that sends it where nothing returns, any of one that sends infinity there.

    Some measure beyond the end that they state.
    """
    assert len(stabilise(scan([49.95, *[50.0] * 99]), standing, OPEN).points) == 1
    assert len(stabilise(scan([49.95, 50.05] * 20 + [math.inf]), standing, OPEN).points) == 20
    assert len(stabilise(scan([49.95, 51.0] * 20), standing, OPEN).points) == 20


def test_the_scan_s_own_limits_hold_too():
    """range_min of the message is respected when it is stricter than the setting."""
    assert len(stabilise(scan([1.0, 2.0, 3.0, 4.0], range_min=2.5), standing, OPEN).points) == 2


def test_beams_without_return_clear_when_asked():
    """+inf and readings at range_max clear up to clear_range; NaN and -inf never do."""
    config = ScanConfig(range_min=0.4, clear_range=5.0)
    got = stabilise(scan([1.0, math.inf, math.nan, 50.0, -math.inf]), standing, config)
    assert len(got.points) == 1
    np.testing.assert_allclose(got.cleared, [[0, 5], [0, -5]], atol=1e-5)


def test_mount_moves_the_laser():
    """A laser in front of the base, facing backwards: endpoints are in the base, the rays start at the laser."""
    mount = Transform(np.array([0.2, 0.0, 0.3]), geometry.from_euler(0.0, 0.0, math.pi))
    got = stabilise(scan([1.0, 2.0], T_base_laser=mount), standing, OPEN)
    np.testing.assert_allclose(got.points, [[-0.8, 0.0], [0.2, -2.0]], atol=1e-5)
    np.testing.assert_allclose(got.laser, [0.2, 0.0])
    np.testing.assert_allclose(got.heights, 0.0, atol=1e-6)


def test_an_upside_down_mount_mirrors_the_scan():
    """A laser rolled by 180 degrees sweeps clockwise seen from above."""
    mount = Transform(np.zeros(3), geometry.from_euler(math.pi, 0.0, 0.0))
    points = stabilise(scan([1.0, 2.0, 3.0, 4.0], T_base_laser=mount), standing, OPEN).points
    np.testing.assert_allclose(points, [[1, 0], [0, -2], [-3, 0], [0, 4]], atol=1e-5)


@pytest.mark.parametrize(("roll", "pitch"), [(0.2, 0.0), (0.0, -0.25), (0.15, 0.2)])
def test_tilt_is_taken_out(roll, pitch):
    """Hits on vertical walls from a tilted robot lie on the walls' outline, at their true height."""
    attitude = geometry.multiply(geometry.yaw_quaternion(0.7), _tilt(roll, pitch))
    R = geometry.rotation_matrix(geometry.split_heading(attitude)[1])
    angles = np.linspace(-2.0, 2.0, 181)
    directions = np.column_stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)]) @ R.T
    ranges = 5.0 / np.hypot(directions[:, 0], directions[:, 1])  # a round wall, 5 m away everywhere
    got = stabilise(
        LaserScan(0, ranges.astype(np.float32), -2.0, angles[1] - angles[0]),
        at_each(lambda _: Transform(np.zeros(3), attitude)),
        OPEN,
    )
    np.testing.assert_allclose(np.hypot(*got.points.T), 5.0, rtol=1e-5)
    np.testing.assert_allclose(got.heights, ranges * directions[:, 2], atol=1e-4)


def _tilt(roll, pitch):
    return geometry.split_heading(geometry.from_euler(roll, pitch, 0.0))[1]


def test_stabilisation_can_be_switched_off():
    """Then the attitude is ignored and only the heading counts."""
    attitude = geometry.from_euler(0.3, 0.2, 0.0)
    config = ScanConfig(range_min=0.0, stabilise=False)
    got = stabilise(scan([1.0, 2.0]), at_each(lambda _: Transform(np.zeros(3), attitude)), config)
    np.testing.assert_allclose(np.hypot(*got.points.T), [1.0, 2.0], rtol=1e-5)


def test_z_band_drops_endpoints_off_the_scan_plane():
    """A robot pitched down by 30 degrees sees the floor ahead: those endpoints are below the band."""
    nose_down = Transform(np.zeros(3), geometry.from_euler(0.0, math.radians(30), 0.0))
    config = ScanConfig(range_min=0.0, z_min=-1.0, z_max=1.0)
    got = stabilise(scan([1.0, 2.0, 1.0, 3.0]), at_each(lambda _: nose_down), config)
    assert len(got.points) == 4
    got = stabilise(scan([2.5, 2.0, 2.5, 3.0]), at_each(lambda _: nose_down), config)
    assert len(got.points) == 2
    assert (np.abs(got.heights) <= 1.0).all()


def test_the_band_is_relative_to_the_laser():
    """A laser mounted 5 m up keeps its level scan."""
    mount = Transform(np.array([0.0, 0.0, 5.0]))
    assert (
        len(stabilise(scan([1.0, 2.0], T_base_laser=mount), standing, ScanConfig(z_min=-0.1, z_max=0.1)).points)
        == 2
    )


def moving(time_ns):
    """1.5 m/s ahead and 2 rad/s to the left, at the origin at one second."""
    t = (time_ns - 1_000_000_000) * 1e-9
    return Transform(
        np.array([0.75 * math.sin(2 * t), 0.75 * (1 - math.cos(2 * t)), 0.0]), geometry.yaw_quaternion(2 * t)
    )


def moving_scan(n=400, sweep_s=0.1):
    """What a round wall of 5 m about the origin looks like to `moving` with real beam timing."""
    angles = np.linspace(-2.0, 2.0, n)
    ranges = np.empty(n, np.float32)
    for i in range(n):
        T = moving(1_000_000_000 + round(i * sweep_s / (n - 1) * 1e9))
        d = geometry.rotate(T.rotation, np.array([math.cos(angles[i]), math.sin(angles[i]), 0.0]))
        along = T.translation @ d
        ranges[i] = -along + math.sqrt(along**2 + 25.0 - T.translation @ T.translation)
    return LaserScan(1_000_000_000, ranges, -2.0, angles[1] - angles[0], time_increment=sweep_s / (n - 1))


def test_deskew_places_each_beam_at_its_own_time():
    """A sweep taken while driving and turning gives the true outline, seen from the middle of the sweep."""
    sweep = moving_scan()
    got = stabilise(sweep, at_each(moving), OPEN)
    world = geometry.transform_points(geometry.planar(moving(sweep.mid_ns)), got.points)
    np.testing.assert_allclose(np.hypot(*world.T), 5.0, atol=0.002)


def test_without_deskew_the_sweep_is_distorted():
    """The same sweep taken as instantaneous is wrong by centimetres: that is what deskewing is for."""
    sweep = moving_scan()
    got = stabilise(sweep, at_each(moving), ScanConfig(range_min=0.0, deskew=False))
    world = geometry.transform_points(geometry.planar(moving(sweep.mid_ns)), got.points)
    assert np.abs(np.hypot(*world.T) - 5.0).max() > 0.03


def test_a_negative_increment_sweeps_the_other_way():
    """Scans may run clockwise."""
    points = stabilise(scan([1.0, 2.0], increment=-math.pi / 2), standing, OPEN).points
    np.testing.assert_allclose(points, [[1, 0], [0, -2]], atol=1e-5)


def test_one_beam_is_a_scan():
    """A single beam breaks nothing."""
    assert len(stabilise(scan([1.0], time_increment=0.01), standing, OPEN).points) == 1
