"""The whole pipeline on made rooms: first scan, thresholds, choices, counters and determinism."""

import gc
import math
import weakref
from dataclasses import replace

import numpy as np
import pytest

from slam_core import geometry
from slam_core.config import ConfigError, MapConfig, MatcherConfig, SlamConfig, with_value
from slam_core.diagnostics import Diagnostic
from slam_core.localization.prior_map import PriorMap, saved_levels
from slam_core.measurements import Attitude, Height, Imu, LaserScan, Odometry
from slam_core.results import PlanarGaussian
from slam_core.slam import HectorSlam
from tests.worlds import room_scan, same_map

CONFIG = SlamConfig(map=MapConfig(size=400))
DT = 100_000_000


def drive(k):
    """A gentle arc: 3 cm and 0.02 rad a scan."""
    psi = 0.02 * k
    return np.array([1.5 * math.sin(psi), 1.5 * (1 - math.cos(psi)), psi])


def run(config=CONFIG, scans=40, extra=()):
    """The pipeline and its results after so many scans of the test room."""
    slam, results = HectorSlam(config), []
    for k in range(scans):
        for measurement in extra:
            slam.step(measurement(k * DT))
        result = slam.step(room_scan(drive(k), k * DT, noise=0.005))
        results += [result] if result else []
    return slam, results


def test_the_first_scan_makes_the_map():
    """It is not matched, lies at the origin, and every level knows it."""
    slam, (first,) = run(scans=1)
    assert first.match is None
    assert first.prior is None
    assert first.map_updated
    np.testing.assert_allclose(first.planar, 0.0)
    assert all((level.log_odds > 0).any() for level in slam.map.levels)


def test_a_pipeline_that_nobody_uses_any_more_is_gone_at_once():
    """Nothing in it refers back to it: a map of a gigabyte does not wait for the garbage collector."""
    run(scans=2)  # to compile a kernel leaves references to what called it
    gc.disable()
    try:
        slam, _ = run(scans=2)
        gone = weakref.ref(slam)
        del slam
        assert gone() is None
    finally:
        gc.enable()


@pytest.mark.parametrize("start", ["filter", "velocity", "last_pose"])
def test_a_drive_is_tracked_with_every_start_estimate(start):
    """Each choice of start estimate follows the room to within a cell."""
    config = with_value(CONFIG, "matcher.start_estimate", start)
    _, results = run(config)
    errors = [r.planar - drive(k) for k, r in enumerate(results)]
    assert len(results) == 40
    assert np.abs(errors).max() < 0.03


def test_start_estimates_differ():
    """They are three different poses: the prediction, the last match moved on, the last match."""
    starts = {}
    for start in ("filter", "velocity", "last_pose"):
        config = with_value(with_value(CONFIG, "matcher.start_estimate", start), "fusion.omega", 0.3)
        slam, _ = run(config, scans=10)
        prior = slam._motion.prior(10 * DT)
        starts[start] = slam.start_estimate(prior, config)
    assert abs(starts["last_pose"] - drive(9)).max() < 0.02
    assert abs(starts["filter"] - drive(10)).max() < abs(starts["last_pose"] - drive(10)).max()
    assert not np.allclose(starts["filter"], starts["velocity"], atol=1e-9)


def test_the_map_is_updated_after_moving_or_turning_far_enough():
    """Moved OR turned since the last update; a still robot never writes twice."""
    assert run(with_value(CONFIG, "map.update_angle", 3.0))[0].map.updates == pytest.approx(
        1 + 39 * 0.03 // 0.4, abs=1
    )
    by_angle = run(with_value(with_value(CONFIG, "map.update_distance", 5.0), "map.update_angle", 0.1))[0]
    assert by_angle.map.updates == pytest.approx(1 + 39 * 0.02 // 0.1, abs=1)
    still = HectorSlam(CONFIG)
    for k in range(20):
        still.step(room_scan(np.zeros(3), k * DT))
    assert still.map.updates == 1


def test_omega_moves_the_fused_ellipse():
    """The more the match counts, the smaller the part of its covariance that bounds the fused one."""
    areas = []
    for omega in (0.01, 0.1, 0.9):
        _, results = run(with_value(CONFIG, "fusion.omega", omega), scans=15)
        areas.append(np.linalg.det(results[-1].fused.covariance[:2, :2]))
        bound = results[-1].match.covariance / omega
        assert np.linalg.eigvalsh(bound - results[-1].fused.covariance).min() > -1e-12
    assert areas[0] > areas[1] > areas[2]


def test_settings_apply_from_the_next_scan():
    """A changed sigma scales R of the next result; a setting that needs a new map is refused."""
    slam, _ = run(scans=3)
    before = slam.step(room_scan(drive(3), 3 * DT)).match
    slam.configure(with_value(slam.config, "matcher.sigma", 2 * slam.config.matcher.sigma))
    after = slam.step(room_scan(drive(4), 4 * DT)).match
    assert np.trace(after.covariance) == pytest.approx(4 * np.trace(before.covariance), rel=0.3)
    with pytest.raises(ConfigError, match="new map"):
        slam.configure(with_value(slam.config, "map.resolution", 0.1))


def test_the_same_measurements_give_the_same_bytes():
    """Two runs agree to the last bit, poses, covariances and map."""
    (a, ra), (b, rb) = run(), run()
    assert all((x.planar == y.planar).all() for x, y in zip(ra, rb, strict=True))
    assert all((x.fused.covariance == y.fused.covariance).all() for x, y in zip(ra, rb, strict=True))
    assert (a.map.levels[0].log_odds == b.map.levels[0].log_odds).all()


@pytest.mark.parametrize("size", [64, 150])
def test_the_size_at_the_start_changes_nothing(size):
    """A map that had to grow gives the poses, covariances and cells of one that was large, to the last bit."""
    (small, grown), (large, whole) = run(with_value(CONFIG, "map.size", size)), run()
    assert small.map.levels[0].shape != (size, size)
    assert all((x.planar == y.planar).all() for x, y in zip(grown, whole, strict=True))
    assert all((x.fused.covariance == y.fused.covariance).all() for x, y in zip(grown, whole, strict=True))
    assert same_map(small.map, large.map)


def test_a_map_at_its_limit_warns_until_the_limit_is_raised():
    """The warning names the limit and the remedy; the drive goes on, and a higher limit ends it."""
    fine = MapConfig(resolution=0.01, size=64, limit=1, update_distance=0.0, update_angle=0.0)
    # A scan that leaves so small a map would otherwise count as lost, and lost scans are not written.
    config = with_value(SlamConfig(map=fine), "tracking.check", False)
    slam, results = run(config, scans=5)
    assert len(results) == 5
    assert slam.diagnostics == (Diagnostic("map_limit", value=1.0),)
    slam.configure(with_value(config, "map.limit", 100))
    slam.step(room_scan(drive(5), 5 * DT))
    assert slam.diagnostics == ()
    assert slam.map.levels[0].shape[0] > 600


def test_absurd_ranges_do_not_make_the_map_grow():
    """NaN, infinite, negative and enormous ranges never reach the map, whatever range the laser claims."""
    slam, _ = run(with_value(CONFIG, "scan.clear_range", 2.0), scans=5)
    shape = slam.map.levels[0].shape
    scan = room_scan(drive(30), 5 * DT)
    ranges = scan.ranges.copy()
    ranges[::7], ranges[1::7], ranges[2::7], ranges[3::7], ranges[4::7] = np.nan, np.inf, -np.inf, 3e38, -5.0
    for range_max in (math.inf, 0.0, 30.0):
        slam.step(replace(scan, ranges=ranges, range_max=range_max))
    assert slam.map.updates > 1
    assert slam.map.levels[0].shape == shape


def test_unusable_scans_are_counted_and_harm_nothing():
    """All-NaN scans are skipped with a reason, and the drive goes on."""
    slam, _ = run(scans=5)
    blind = LaserScan(5 * DT, np.full(541, np.nan, np.float32), -2.0, 0.01)
    assert slam.step(blind) is None
    assert sum(slam.status.skipped.values()) == 1
    result = slam.step(room_scan(drive(6), 6 * DT))
    assert np.abs(result.planar - drive(6)).max() < 0.03


def test_the_number_of_beams_may_change():
    """Scans of 541, 540 and 2 beams all pass."""
    slam, _ = run(scans=3)
    assert slam.step(room_scan(drive(3), 3 * DT, beams=540)).beams == 540
    assert slam.step(room_scan(drive(3), 4 * DT, beams=2)).beams == 2


def still_imu(t):
    """A level, resting inertial sample."""
    return Imu(t, np.zeros(3), np.array([0.0, 0.0, 9.80665]))


def test_with_inertial_data_scans_wait_for_the_attitude():
    """Until the filter has leveled, scans are skipped with a reason; then the state is full 6DOF."""
    slam, results = HectorSlam(CONFIG), []
    for k in range(200):
        slam.step(still_imu(k * 10_000_000))
        if k % 10 == 0:
            result = slam.step(room_scan(np.zeros(3), k * 10_000_000))
            results += [result] if result else []
    assert slam.status.skipped["scan before the attitude was known"] >= 1
    assert results[-1].navigation is not None
    assert np.linalg.eigvalsh(results[-1].navigation.covariance).min() > 0
    np.testing.assert_allclose(results[-1].T_map_base.translation[:2], 0.0, atol=0.02)


def test_the_scan_that_makes_the_map_may_be_older_than_the_filter():
    """It waited for the attitude and lies before it: there is nothing to fuse it with, which is no fault of it."""
    slam, results = HectorSlam(CONFIG), []
    for k in range(10, 200):
        slam.step(still_imu(k * 10_000_000))
        if k % 10 == 0:
            result = slam.step(room_scan(np.zeros(3), k * 10_000_000 - 30_000_000))
            results += [result] if result else []
    first, last = results[0], results[-1]
    assert first.stamp_ns < first.navigation.stamp_ns
    assert {status.source: dict(status.dropped) for status in last.aiding}["scan"] == {}
    assert not slam.status.unused


@pytest.mark.parametrize("period, end, gyro", [(0.01, 0.2, 0.0), (0.25, 99.0, 0.0), (0.01, 99.0, math.nan)])
def test_inertial_data_that_shows_no_attitude_is_not_waited_for_without_end(period, end, gyro):
    """It ends at once, has gaps, or no values: scans are matched without it, and the fault is named."""
    slam, results, k = HectorSlam(CONFIG), [], 0
    for i in range(60):
        while k * period <= min(0.1 * i, end):
            slam.step(Imu(round(k * period * 1e9), np.array([0.0, 0.0, gyro]), np.array([0.0, 0.0, 9.81])))
            k += 1
        result = slam.step(room_scan(drive(i), i * DT, noise=0.005))
        results += [result] if result else []
    assert len(results) > 30
    assert "no_attitude" in {diagnostic.code for diagnostic in slam.diagnostics}
    assert (
        np.abs(results[-1].planar - geometry.compose(geometry.inverse(drive(60 - len(results))), drive(59))).max()
        < 0.05
    )


def test_a_person_can_say_where_a_robot_is_that_no_search_finds():
    """Only after a scan was looked for: the map of a room with two alike places is no help."""
    slam, _ = run(scans=5)
    prior_map = PriorMap("room", saved_levels(slam.map), start=None)
    strict = with_value(CONFIG, "tracking.relocalise_min_inlier_ratio", 1.0)
    begun = HectorSlam(strict, prior_map)
    here = PlanarGaussian(drive(2), np.diag([0.1, 0.1, 0.1]) ** 2)
    assert not begun.reset_pose(here)
    assert begun.step(room_scan(drive(2), 0, noise=0.05)) is None
    assert begun.status.search_failure is not None
    assert begun.reset_pose(here)
    result = begun.step(room_scan(drive(2), DT, noise=0.005))
    np.testing.assert_allclose(result.planar, drive(2), atol=0.03)
    assert begun.status.search_failure is None


def test_a_lost_robot_stays_where_a_person_said_that_it_is():
    """Until a match is good again; not at the origin, which was never said."""
    slam, _ = run(config=with_value(CONFIG, "tracking.relocalise", False))
    there = np.array([0.5, -0.4, 0.1])
    assert slam.reset_pose(PlanarGaussian(there, np.diag([0.1, 0.1, 0.1]) ** 2))
    ranges = np.random.default_rng(1).uniform(0.5, 3.0, len(room_scan(there, 0).ranges)).astype(np.float32)
    for k in range(40, 70):
        result = slam.step(replace(room_scan(there, k * DT), ranges=ranges))
    assert result.verdict.state == "lost"
    np.testing.assert_allclose(result.planar, there, atol=0.05)


def test_without_checks_nothing_remains_of_a_search():
    """Who switches checks off while the robot is lost gets no reason of that time for it."""
    slam, _ = run()
    ranges = np.random.default_rng(1).uniform(0.5, 3.0, len(room_scan(drive(0), 0).ranges)).astype(np.float32)
    for k in range(40, 70):
        slam.step(replace(room_scan(drive(40), k * DT), ranges=ranges))
    assert slam.status.search_failure is not None
    slam.configure(with_value(CONFIG, "tracking.check", False))
    slam.step(room_scan(drive(40), 70 * DT))
    assert slam.status.search_failure is None


@pytest.mark.parametrize("time_increment", [math.nan, math.inf, -math.inf])
def test_a_scan_whose_beams_have_no_times_is_one_of_an_instant(time_increment):
    """Time increments that are no numbers count as none."""
    scan = replace(room_scan(drive(0), 5), time_increment=time_increment)
    assert scan.end_ns == scan.mid_ns == 5


def test_heights_reach_the_filter():
    """A barometer moves z of the pose."""
    slam, last = HectorSlam(CONFIG), None
    for k in range(600):
        slam.step(still_imu(k * 10_000_000))
        slam.step(Height(k * 10_000_000, 0.5 if k > 100 else 0.0))
        if k % 10 == 0:
            last = slam.step(room_scan(np.zeros(3), k * 10_000_000)) or last
    assert last.T_map_base.translation[2] == pytest.approx(0.5, abs=0.15)


def test_attitudes_alone_stabilise():
    """Without inertial data a given attitude levels the scan and shows in the pose."""
    slam = HectorSlam(CONFIG)
    tilt = geometry.from_euler(0.2, 0.0, 0.0)
    slam.step(Attitude(0, tilt))
    result = slam.step(room_scan(np.zeros(3), 0))
    np.testing.assert_allclose(geometry.to_euler(result.T_map_base.rotation)[0], 0.2, atol=1e-6)
    assert np.abs(result.heights).max() > 0.3


def test_odometry_reaches_the_prediction():
    """Wheels set the start estimate of a scan after a long gap."""
    slam = HectorSlam(CONFIG)
    slam.step(room_scan(np.zeros(3), 0))
    for k in range(1, 11):
        slam.step(Odometry(k * DT, np.array([0.3, 0.0]), 0.0))
    result = slam.step(room_scan(np.array([0.3, 0.0, 0.0]), 10 * DT))
    assert result.prior.mean[0] == pytest.approx(0.3, abs=0.03)
    assert result.planar[0] == pytest.approx(0.3, abs=0.03)


def test_durations_come_from_the_clock_that_is_given():
    """The core reads no clock of its own: without one all durations are 0."""
    ticks = iter(range(10**9))
    timed = HectorSlam(CONFIG, clock=lambda: next(ticks))
    assert timed.step(room_scan(np.zeros(3))).durations.stabilise > 0
    assert HectorSlam(CONFIG).step(room_scan(np.zeros(3))).durations.match == 0


def test_durations_are_of_the_scan_alone():
    """What scans took that were skipped before is not in them."""
    ticks = iter(range(10**9))
    timed = HectorSlam(CONFIG, clock=lambda: next(ticks))
    empty = replace(room_scan(np.zeros(3)), ranges=np.full(360, np.inf, np.float32), range_min=5.0)
    for _ in range(5):
        assert timed.step(empty) is None
    alone = HectorSlam(CONFIG, clock=lambda: next(ticks)).step(room_scan(np.zeros(3)))
    assert timed.step(room_scan(np.zeros(3))).durations == alone.durations


def test_the_sampled_covariance_runs_in_the_pipeline():
    """The choice of covariance reaches the fusion."""
    config = SlamConfig(map=CONFIG.map, matcher=MatcherConfig(covariance="sampled"))
    _, results = run(config, scans=8)
    assert np.abs(results[-1].planar - drive(7)).max() < 0.03
    assert np.linalg.eigvalsh(results[-1].match.covariance).min() > 0


def test_odometry_reaches_the_filter():
    """With inertial data the wheels correct the filter's velocity."""
    speeds = []
    for wheels in (False, True):
        slam, last = HectorSlam(CONFIG), None
        for k in range(200):
            slam.step(still_imu(k * 10_000_000))
            if wheels and k > 100:
                slam.step(Odometry(k * 10_000_000, np.array([0.2, 0.0]), 0.0))
            if k % 10 == 0:
                last = slam.step(room_scan(np.zeros(3), k * 10_000_000, noise=0.005)) or last
        speeds.append(last.navigation.velocity[0])
    assert speeds[1] > speeds[0] + 0.02


def corridor_scan(x, stamp_ns):
    """Walls one metre to either side and ends at -3 m and 20 m; the laser sees 8 m."""
    angles = np.linspace(-3.1, 3.1, 720)
    ahead, aside = np.cos(angles), np.abs(np.sin(angles))
    ends = np.where(ahead > 0.0, 20.0 - x, 3.0 + x) / np.abs(ahead)
    ranges = np.minimum(1.0 / aside, ends)
    ranges[ranges > 8.0] = np.inf
    noise = np.random.default_rng(stamp_ns // DT).normal(0.0, 0.005, len(ranges))
    return LaserScan(stamp_ns, (ranges + noise).astype(np.float32), -3.1, angles[1] - angles[0], range_max=8.0)


def along_corridor(prior_map=None):
    """The pipeline after 15 m by wheels, and how uncertain it is along at every scan."""
    slam, sigmas = HectorSlam(CONFIG, prior_map), []
    for k in range(301):
        slam.step(Odometry(k * DT, np.array([0.5, 0.0]), 0.0))
        result = slam.step(corridor_scan(0.05 * k, k * DT))
        sigmas += [math.sqrt(result.fused.covariance[0, 0])] if result else []
    return slam, sigmas


def test_what_an_open_direction_cost_is_claimed_on_a_map_drawn_meanwhile_and_on_no_other():
    """Mapping, the end of the corridor takes little back; a robot that only seeks its place is sure of it."""
    slam, mapping = along_corridor()
    assert mapping[-1] > 0.8 * max(mapping) > 0.02
    _, localised = along_corridor(PriorMap("corridor", saved_levels(slam.map), start=np.zeros(3)))
    assert max(localised) > 0.02
    assert localised[-1] < 0.25 * max(localised)
