"""The search for a lost robot: spread over scans within its budget, and brought up to the newest of them."""

import numpy as np
import pytest

from slam_core import geometry
from slam_core.config import MapConfig, SlamConfig
from slam_core.localization import place_search, relocalisation
from slam_core.localization.place_search import PlaceSearch
from slam_core.localization.relocalisation import Relocaliser
from slam_core.localization.search_parts import Region
from slam_core.mapping.pyramid import Pyramid
from slam_core.scan.stabilise import StabilisedScan, stabilise
from tests.worlds import room_scan, standing

CONFIG = SlamConfig(map=MapConfig(size=400))
FIRST = np.array([-1.0, 0.5, 0.3])
STEP = np.array([0.05, 0.0, 0.02])  # of the robot between two scans, in its own frame
PREDICTED = np.array([7.0, -3.0, 2.0])  # by a pose that is wrong, but moves as the robot does
EVERY_NS = 50_000_000


def seen(pose: np.ndarray) -> StabilisedScan:
    """The test room from a pose."""
    return stabilise(room_scan(pose), standing, CONFIG.scan)


@pytest.fixture(scope="module")
def room() -> Pyramid:
    """The test room, mapped from four places."""
    pyramid = Pyramid(CONFIG.map)
    for pose in np.array([[0, 0, 0], [1, -1, 1], [-1, 1, 2], [-2, -1, 3]], float):
        scan = seen(pose)
        pyramid.update(scan.points, scan.cleared, scan.laser, pose, CONFIG.map)
    return pyramid


def test_what_fits_into_the_budget_is_found_in_its_own_scan(room: Pyramid):
    """No second scan is needed in a room."""
    found = Relocaliser(np.zeros(3)).search(room, seen(FIRST), 0, PREDICTED, None, CONFIG)
    assert found is not None
    np.testing.assert_allclose(found.pose, FIRST, atol=0.03)


def test_of_a_scan_that_is_half_new_the_place_of_the_matches_is_found_if_no_other_fits(room: Pyramid):
    """Nobody else finds it, nor does one whose matches are elsewhere."""
    scan = seen(FIRST)
    points = scan.points.copy()
    points[::3] *= 3.0  # into what is not mapped
    scan = scan._replace(points=points)
    assert Relocaliser(np.zeros(3)).search(room, scan, 0, PREDICTED, None, CONFIG) is None
    found = Relocaliser(np.zeros(3)).search(room, scan, 0, PREDICTED, None, CONFIG, FIRST)
    assert found is not None
    np.testing.assert_allclose(found.pose, FIRST, atol=0.03)
    elsewhere = np.array([1.0, -1.0, 2.0])
    relocaliser = Relocaliser(np.zeros(3))
    assert relocaliser.search(room, scan, 0, PREDICTED, None, CONFIG, elsewhere) is None
    assert relocaliser.failure is not None  # of a place that is not known


@pytest.mark.parametrize("region", [None, Region(FIRST, 2.0)])
def test_a_long_search_goes_on_with_the_next_scans(
    room: Pyramid, monkeypatch: pytest.MonkeyPatch, region: Region | None
):
    """What is found for the first scan is moved as the prediction moved since. No second exceeds its budget."""
    budget, part = 4e5, 20_000
    monkeypatch.setattr(relocalisation, "BUDGET", budget)
    monkeypatch.setattr(relocalisation, "AT_ONCE", budget)
    monkeypatch.setattr(place_search, "WORK", part)
    spent: list[float] = []
    advance = PlaceSearch.advance
    monkeypatch.setattr(PlaceSearch, "advance", lambda self, work: spent.append(advance(self, work)) or spent[-1])
    relocaliser = Relocaliser(np.zeros(3))
    truth, predicted, found, k = FIRST, PREDICTED, None, 0
    while found is None and k < 2000:
        found = relocaliser.search(room, seen(truth), k * EVERY_NS, predicted, region, CONFIG)
        assert (relocaliser.failure is not None) == (found is None)
        if found is None:
            truth, predicted = geometry.compose(truth, STEP), geometry.compose(predicted, STEP)
            k += 1
    assert k > 1
    assert found is not None
    np.testing.assert_allclose(found.pose[:2], truth[:2], atol=0.03)
    assert sum(spent) <= budget * (1.0 + k * EVERY_NS * 1e-9) + 5 * part


def test_a_place_from_which_the_robot_cannot_have_come_is_none(room: Pyramid):
    """It fits as well, and lies as far from where the robot was as that has moved since, but the other way."""
    motion = np.array([1.5, 0.0, 0.4])
    come = geometry.compose(FIRST, geometry.inverse(motion))
    gone = geometry.compose(FIRST, motion)
    for start, reachable in ((come, True), (gone, False)):
        region = Region(start, 0.5, motion)
        assert np.hypot(*(FIRST - start)[:2]) < region.reach
        found = Relocaliser(np.zeros(3)).search(room, seen(FIRST), 0, PREDICTED, region, CONFIG)
        assert (found is not None) == reachable


def test_a_search_ends_when_the_pose_is_known(room: Pyramid, monkeypatch: pytest.MonkeyPatch):
    """What it would have found is not used any more: the next one begins with the scan of its time."""
    monkeypatch.setattr(relocalisation, "BUDGET", 3e5)
    monkeypatch.setattr(relocalisation, "AT_ONCE", 3e5)
    monkeypatch.setattr(place_search, "WORK", 100_000)
    relocaliser = Relocaliser(np.zeros(3))
    assert relocaliser.search(room, seen(FIRST), 0, PREDICTED, None, CONFIG) is None
    assert relocaliser.failure is not None
    relocaliser.reset()
    assert relocaliser.failure is None
    assert relocaliser.search(room, seen(FIRST), EVERY_NS, PREDICTED, None, CONFIG) is None  # none is due
    assert relocaliser.failure is None
