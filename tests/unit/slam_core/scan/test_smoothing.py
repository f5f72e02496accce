"""The noise of a laser is measured by its scans, and taken out where walls are straight."""

import math
from dataclasses import replace

import numpy as np
import pytest

from slam_core.config import ScanConfig
from slam_core.measurements import Float32s, Float64s, LaserScan
from slam_core.scan.smoothing import Smoothing

BEAMS = 721
ANGLES = np.linspace(-math.pi, math.pi, BEAMS, endpoint=False)
CONFIG = ScanConfig()


def room(x: float = 0.0, turn: float = 0.0, half: float = 6.0) -> Float64s:
    """(n,) ranges in the middle of a square room, or beside it, by a laser that is turned."""
    across, along = np.cos(ANGLES + turn), np.sin(ANGLES + turn)
    with np.errstate(divide="ignore"):
        return np.minimum((np.where(across > 0.0, half, -half) - x) / across, half / np.abs(along))


def scan(ranges: Float64s, noise: float, seed: int) -> LaserScan:
    """With a noise of so much of every range."""
    factors = 1.0 + noise * np.random.default_rng(seed).standard_normal(len(ranges))
    return LaserScan(seed, (ranges * factors).astype(np.float32), -math.pi, 2 * math.pi / BEAMS, range_max=30.0)


def smoothed(scans: list[LaserScan], config: ScanConfig = CONFIG) -> tuple[Smoothing, list[LaserScan]]:
    """What is known after them, and what became of them."""
    smoothing = Smoothing()
    return smoothing, [smoothing.take(each, config) for each in scans]


def off(ranges: Float32s, truth: Float64s) -> float:
    """The median distance of ranges from the true ones."""
    return float(np.median(np.abs(ranges - truth)))


@pytest.mark.parametrize("moves", [0.0, 0.02])
@pytest.mark.parametrize("noise", [0.002, 0.01, 0.03])
def test_the_noise_is_measured(noise: float, moves: float) -> None:
    """Of a laser at rest or of one that drives and turns, to a quarter."""
    smoothing, _ = smoothed([scan(room(moves * k, moves * k), noise, k + 1) for k in range(100)])
    known = smoothing.noise[8:10]  # of ranges from 4 to 8 m
    np.testing.assert_allclose(known[known >= 0.0], noise * np.array([4.8, 6.7])[known >= 0.0], rtol=0.25)
    assert known[1] > 0.0


def test_walls_become_thin() -> None:
    """1 % of 6 to 8 m: less than a third of the noise is left."""
    truth = room()
    _, found = smoothed([scan(truth, 0.01, k + 1) for k in range(10)])
    assert off(found[-1].ranges, truth) < off(scan(truth, 0.01, 10).ranges, truth) / 3.0


@pytest.mark.parametrize("noise", [0.0, 0.004])
def test_a_laser_with_little_noise_is_left_alone(noise: float) -> None:
    """Its scans are passed on as they are."""
    scans = [scan(room(0.01 * k), noise, k + 1) for k in range(30)]
    _, found = smoothed(scans)
    assert all(each is other for each, other in zip(found, scans, strict=True))


def test_nothing_is_smoothed_if_it_is_switched_off() -> None:
    """By the setting, of a laser with much noise as well."""
    scans = [scan(room(), 0.03, k + 1) for k in range(10)]
    _, found = smoothed(scans, ScanConfig(smooth_noise=0.0))
    assert all(each is other for each, other in zip(found, scans, strict=True))


def test_what_is_no_noise_stays() -> None:
    """A door frame of 40 cm in a wall at 6 m, a post and a doorway keep their places within the noise."""
    truth = room()
    truth[300:312] -= 0.4
    truth[400:403] = 3.0
    truth[430:445] = 12.0
    _, found = smoothed([scan(truth, 0.01, k + 1) for k in range(10)])
    for place in (slice(301, 311), slice(400, 403), slice(431, 444)):  # at an edge a beam may be of both walls
        assert np.abs(found[-1].ranges[place] - truth[place]).max() < 0.04 * truth[place].max()


def test_structure_is_no_noise() -> None:
    """Beams that end anywhere in a bush, in every scan where they did before, are not smoothed."""
    bush = room() - np.random.default_rng(0).uniform(0.0, 1.0, BEAMS)
    scans = [scan(bush, 0.001, k + 1) for k in range(10)]
    _, found = smoothed(scans)
    assert all(each is other for each, other in zip(found, scans, strict=True))


def test_a_scan_that_is_sent_again_tells_nothing() -> None:
    """A driver that hangs is no laser without noise."""
    scans = [scan(room(), 0.01, k + 1) for k in range(10)]
    smoothing, _ = smoothed(scans)
    known = smoothing.noise.copy()
    for k in range(40):
        smoothing.take(replace(scans[-1], stamp_ns=20 + k), CONFIG)
    np.testing.assert_array_equal(smoothing.noise, known)


def test_beams_without_a_range_keep_none() -> None:
    """REP-117: infinity and NaN stay, and their neighbours are smoothed without them."""
    truth, none = room(), np.arange(BEAMS) % 9 == 0
    scans = [scan(np.where(none, (math.inf, math.nan)[k % 2], truth), 0.01, k + 1) for k in range(10)]
    _, found = smoothed(scans)
    ranges = found[-1].ranges
    np.testing.assert_array_equal(np.isfinite(ranges), ~none)
    assert off(ranges[~none], truth[~none]) < off(scans[-1].ranges[~none], truth[~none]) / 2.5


def test_a_scan_with_few_ranges_of_much_noise_stays_as_it_is() -> None:
    """A doorway to a far room, in near walls."""
    truth = room(half=1.5)
    truth[100:170] = 12.0
    scans = [scan(truth, 0.01, k + 1) for k in range(10)]
    smoothing, found = smoothed(scans)
    assert smoothing.noise.max() > CONFIG.smooth_noise
    np.testing.assert_array_equal(found[-1].ranges, scans[-1].ranges)


def test_what_scatters_by_more_than_any_laser_is_no_noise() -> None:
    """Grass in the wind ends beams anywhere, and elsewhere in each scan: a tenth of the range is not smoothed."""
    scans = [scan(room(), 0.1, k + 1) for k in range(10)]
    _, found = smoothed(scans)
    np.testing.assert_array_equal(found[-1].ranges, scans[-1].ranges)


def mean_after_smoothing(truth: Float64s) -> Float64s:
    """(n,) of ranges with a noise of 1 %, once that is known."""
    _, found = smoothed([scan(truth, 0.01, k + 1) for k in range(50)])
    return np.mean([each.ranges for each in found[10:]], axis=0)


def facing() -> list[int]:
    """The beams on the two walls beside the laser."""
    return [i for i in range(BEAMS) if abs(abs(ANGLES[i]) - math.pi / 2) < 0.7]


@pytest.mark.parametrize(("every", "wide", "out"), [(24, 6, 0.15), (4, 2, 0.2), (20, 1, 0.25)])
def test_what_stands_out_of_a_wall_stays(every: int, wide: int, out: float) -> None:
    """Pillars that a window would span, pickets of a fence, thin posts: most of their depth is left."""
    truth = room()
    before = [i for i in facing() if i % every < wide]
    truth[before] *= 1.0 - out / 6.0
    assert np.median(mean_after_smoothing(truth)[before] - truth[before]) < 0.4 * out
