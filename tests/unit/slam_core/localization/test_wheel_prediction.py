"""What a prediction by wheels weighs, and when a scan contradicts it."""

import numpy as np
import pytest

from slam_core.config import SlamConfig, with_value
from slam_core.localization.dynamic_beams import foreground
from slam_core.localization.wheel_prediction import REACH, slipped, weighed
from slam_core.mapping.pyramid import Pyramid
from slam_core.results import Fit, MatchResult, PlanarGaussian
from tests.unit.slam_core.localization.test_dynamic_beams import mapped, points

CONFIG = SlamConfig()
BEHIND, BESIDE = (-2.0, 0.0), (1.0, 0.4)
TRUE = np.array([0.3, 0.0, 0.0])


def at(x: float, y: float = 0.0, psi: float = 0.0) -> MatchResult:
    """A match at a pose."""
    pose, nothing = np.array([x, y, psi]), np.zeros((0, 4))
    return MatchResult(
        pose, np.eye(3), np.eye(3), np.zeros(1), (1,), True, nothing, np.zeros(2), 1.0, Fit(0.9, 0.9)
    )


def prior(x: float) -> PlanarGaussian:
    """A prediction."""
    return PlanarGaussian(np.array([x, 0.0, 0.0]), np.diag([0.03, 0.03, 0.02]) ** 2)


def bearing_of(ends: np.ndarray) -> np.ndarray:
    """(n,) radians."""
    bearings: np.ndarray = np.arctan2(ends[:, 1], ends[:, 0])
    return bearings


def test_wheels_weigh_as_configured():
    """And as other predictions where that is 0."""
    assert weighed(CONFIG).matcher.prior_weight == CONFIG.matcher.wheels_weight
    off = with_value(CONFIG, "matcher.wheels_weight", 0.0)
    assert weighed(off) is off


@pytest.mark.parametrize("predicted", [0.22, 0.38])
def test_walls_that_fit_clearly_better_elsewhere_show_slip(predicted: float):
    """The robot is 8 cm from where its wheels have it; its own match is right."""
    scan, pyramid = points(TRUE, BEHIND), mapped(BEHIND)
    assert slipped(pyramid, scan, at(predicted), at(0.3), prior(predicted))


def test_a_match_that_is_no_better_shows_none():
    """Neither one at the same place nor one that is wrong."""
    scan, pyramid = points(TRUE, BEHIND), mapped(BEHIND)
    assert not slipped(pyramid, scan, at(0.3), at(0.3), prior(0.3))
    assert not slipped(pyramid, scan, at(0.3), at(0.15), prior(0.3))


def test_somebody_who_walks_along_is_no_slip():
    """Only the beams on the person fit better where the map has the person."""
    true, person = np.array([0.15, 0.0, 0.0]), BESIDE
    scan, pyramid = points(true, (person[0] + 0.15, person[1])), mapped(person)
    assert not slipped(pyramid, scan, at(0.15), at(0.0), prior(0.15))


def test_somebody_beside_whom_nothing_returns_is_no_slip():
    """Though the next endpoint, far to the side, is nearer: another one walks there."""
    true, person = np.array([0.15, 0.0, 0.0]), BESIDE
    scan = points(true, (person[0] + 0.15, person[1]), (true[0], 0.6))
    bearing, (before, after) = bearing_of(scan), np.arctan2([person[1], 0.6], [person[0], 0.27])
    seen = scan[((bearing < before + 0.22) | (bearing > after)) & (np.hypot(*scan.T) < 4.0)]
    pyramid = mapped(person)
    assert not slipped(pyramid, seen, at(0.15), at(0.0), prior(0.15))
    assert not foreground(seen)[np.abs(bearing_of(seen) - before) < 0.1].any()


def test_a_match_far_off_is_no_slip():
    """Between two scans wheels slip by centimetres, however well the scan fits there."""
    scan, pyramid = points(TRUE, BEHIND), mapped(BEHIND)
    off = 0.3 + REACH + 0.05
    assert not slipped(pyramid, scan, at(off), at(0.3), prior(off))
    assert not slipped(
        pyramid, scan, at(0.3, psi=0.5), at(0.3), PlanarGaussian(np.array([0.3, 0.0, 0.5]), np.eye(3))
    )


def test_a_scan_of_people_shows_no_slip():
    """Too few of its beams end on walls."""
    crowd = [(0.9, 0.3), (0.9, -0.3), (0.5, 0.6), (0.5, -0.6)]
    scan, pyramid = points(TRUE, *((x + 0.3, y) for x, y in crowd)), mapped(BEHIND)
    assert foreground(scan).mean() > 0.5
    assert not slipped(pyramid, scan, at(0.22), at(0.3), prior(0.22))


def test_unknown_cells_tell_nothing():
    """Where the map ends, most beams end on these: a match back on known walls fits only seemingly better."""
    scan = points(TRUE, BEHIND)
    pyramid, few = Pyramid(CONFIG.map), np.hypot(*scan.T) < 1.15
    for _ in range(5):
        pyramid.update(scan[few], np.empty((0, 2), np.float32), TRUE[:2], TRUE, CONFIG.map)
    assert 0.2 < few.mean() < 0.5
    assert not slipped(pyramid, scan, at(0.22), at(0.3), prior(0.22))
    assert slipped(pyramid, scan[few], at(0.22, 0.05), at(0.3), prior(0.22))
