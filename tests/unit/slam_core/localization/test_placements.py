"""Where a local map may lie in the map: what the scans of all of it agree with, and nothing else."""

import numpy as np
import pytest

from slam_core import geometry
from slam_core.config import MapConfig, SlamConfig
from slam_core.localization import placements as module
from slam_core.localization.placements import (
    CROSSING,
    EVIDENCE,
    HELD_NS,
    MISSES,
    MOST,
    NOTHING,
    OFTEN,
    SPREAD,
    UNLIKELY,
    KeptScan,
    Placement,
    Placements,
    Support,
    Usual,
    crossings,
    refined,
    support,
)
from slam_core.mapping.pyramid import Pyramid
from slam_core.scan.stabilise import StabilisedScan, stabilise
from tests.worlds import mapped_room, room_scan, standing

CONFIG = SlamConfig(map=MapConfig(size=400))
HERE = np.array([0.5, -0.5, 0.2])
MOVED = np.array([0.7, -0.4, 0.9])  # of the local map in the map
ASIDE = np.array([0.7, -0.5, 0.2])
ELSEWHERE = np.array([5.0, 1.0, -2.0])
USUAL = Usual(hit=0.95, crossing=0.02)
GOOD = Support(known=8.0, agreeing=8.0, spread=3.0, misfit=0.05, crossing=0.0)


@pytest.fixture(scope="module")
def room() -> Pyramid:
    """The test room, mapped from four places."""
    return mapped_room(CONFIG)


def kept(moved: np.ndarray) -> list[KeptScan]:
    """Scans of the test room along 3.5 m, as a local map that lies at a placement (3,) has them."""
    found = []
    for k, x in enumerate(np.arange(-2.0, 1.5, 0.3)):
        pose = np.array([x, -1.0 + 0.1 * x, 0.1 * x])
        scan = stabilise(room_scan(pose), standing, CONFIG.scan)
        found.append(KeptScan(scan, geometry.compose(geometry.inverse(moved), pose), k))
    return found


def tried(*supports: Support) -> tuple[Placements, list[Placement]]:
    """Placements apart from each other with a support each."""
    placements = Placements()
    placements.add([np.array([3.0 * k, 0.0, 0.0]) for k in range(len(supports))], np.zeros(3))
    for placement, each in zip(placements._tried, supports, strict=True):
        placement.support = each
    return placements, placements._tried


def chosen(placements: Placements) -> Placement | None:
    """The one that is the best for long enough."""
    placements.best(HERE, 0)
    return placements.best(HERE, HELD_NS)


def test_the_map_explains_the_scans_where_they_were_made(room: Pyramid):
    """All of them agree, over all of their path, and next to nothing lies in free space."""
    found = support(room, kept(MOVED), MOVED, USUAL)
    assert found.known > EVIDENCE
    assert found.agreeing == found.known
    assert found.spread > SPREAD
    assert found.misfit < 0.1
    assert found.crossing < 0.0


def test_elsewhere_the_scans_contradict_the_map(room: Pyramid):
    """Half a turn off in a nearly symmetric room most endpoints hit no wall, or lie in free space."""
    turned = geometry.compose(np.array([0.5, 0.5, np.pi]), MOVED)
    found = support(room, kept(MOVED), turned, USUAL)
    assert found.contradicts
    assert found.misfit > 0.3


def test_scans_beyond_the_map_show_nothing(room: Pyramid):
    """Neither for nor against a placement."""
    found = support(room, kept(MOVED), geometry.compose(np.array([40.0, 0.0, 0.0]), MOVED), USUAL)
    assert found == NOTHING
    assert not found.contradicts


@pytest.fixture(scope="module")
def half_room() -> Pyramid:
    """The test room, mapped where x is above 1 m."""
    pyramid = Pyramid(CONFIG.map)
    pose = np.array([-1.0, -1.0, 0.0])
    scan = stabilise(room_scan(pose), standing, CONFIG.scan)
    seen = scan.points[scan.points[:, 0] - 1.0 > 1.0]
    pyramid.update(seen, scan.cleared[:0], scan.laser, pose, CONFIG.map)
    return pyramid


def test_beams_that_cross_walls_into_the_unknown_contradict_a_placement(half_room: Pyramid):
    """Endpoints alone say little there: those beyond the map count for nothing, however they came there."""
    scans = 2 * kept(MOVED)
    true, wrong = (
        support(half_room, scans, geometry.compose(np.array([x, 0.0, 0.0]), MOVED), USUAL) for x in (0.0, 2.5)
    )
    assert true.crossing < 0.0
    assert wrong.agreeing == wrong.known > EVIDENCE
    assert wrong.crossing > UNLIKELY
    assert wrong.contradicts
    often = support(half_room, scans, MOVED, USUAL._replace(crossing=0.5))
    assert often.crossing == pytest.approx(true.crossing - OFTEN * 0.48)


def test_a_beam_that_ends_on_a_wall_crosses_none(room: Pyramid):
    """It was seen through glass: walls before its end do not count, nor those within reach of its end."""
    scan = stabilise(room_scan(np.zeros(3)), standing, CONFIG.scan)
    known, crossing = crossings(room, scan, np.zeros(3))
    assert known >= 20
    assert crossing == 0
    beyond = scan._replace(points=scan.points * np.float32(1.5))
    known, crossing = crossings(room, beyond, np.zeros(3))
    assert crossing > 0.9 * known
    behind = scan._replace(points=(scan.points * np.float32(1.02)))
    assert crossings(room, behind, np.zeros(3))[1] == 0
    endless = scan._replace(points=scan.points * np.float32(1e30))
    assert crossings(room, endless, np.zeros(3))[1] > 0.9 * known
    assert crossings(room, scan, np.full(3, np.nan)) == (0, 0)
    assert crossings(room, scan, np.array([1e18, -1e18, 0.0])) == (0, 0)


def test_a_placement_is_refined_by_the_scans_of_the_whole_local_map(room: Pyramid):
    """From 10 cm and 2 degrees off to less than 1 cm at the robot, far from the origin of the local map or not."""
    local = geometry.compose(MOVED, np.array([-30.0, 20.0, 1.0]))
    scans = kept(local)
    off = geometry.compose(np.array([0.1, -0.05, 0.03]), geometry.compose(local, scans[-1].pose))
    found = refined(room, scans, geometry.compose(off, geometry.inverse(scans[-1].pose)), CONFIG)
    for scan in (scans[0], scans[-1]):
        true = geometry.compose(local, scan.pose)
        np.testing.assert_allclose(geometry.compose(found, scan.pose), true, atol=0.01)


def test_a_placement_is_not_drawn_to_the_other_side_of_a_wall():
    """The scans see a wall from behind, 15 cm thick: its mapped side is not where they end."""
    pyramid, xs = Pyramid(CONFIG.map), np.arange(-3.0, 3.0, 0.02)
    scan = stabilise(room_scan(np.zeros(3)), standing, CONFIG.scan)

    def seen(distance: float) -> StabilisedScan:
        points = np.column_stack([xs, np.full_like(xs, distance)]).astype(np.float32)
        return scan._replace(points=points, heights=np.zeros(len(points), np.float32))

    for _ in range(3):
        pyramid.update(seen(1.0).points, scan.cleared[:0], scan.laser, np.zeros(3), CONFIG.map)
    for thickness, drawn in ((0.15, 0.0), (-0.1, 0.1)):
        away = np.array([0.0, 3.0 + thickness, 0.0]) if thickness > 0.0 else np.array([0.0, thickness, 0.0])
        kept_scan = KeptScan(seen(-2.0 if thickness > 0.0 else 1.0), away, 0)
        found = refined(pyramid, [kept_scan], np.zeros(3), CONFIG)
        np.testing.assert_allclose(found[1], drawn, atol=0.03)


def test_a_placement_of_which_next_to_nothing_is_known_stays_where_it_is(room: Pyramid):
    """A match of so few endpoints would carry it off, up to kilometres a round."""
    scans = kept(MOVED)
    aside = geometry.compose(np.array([7.0, 0.5, 0.0]), MOVED)
    np.testing.assert_array_equal(refined(room, scans, aside, CONFIG), aside)


def test_the_true_place_remains_of_those_that_were_tried(room: Pyramid):
    """Places that the scans contradict are given up, each in its turn."""
    scans = kept(MOVED)
    placements = Placements()
    here = scans[-1].pose
    true = geometry.compose(MOVED, here)
    placements.add([geometry.compose(np.array([0.5, 0.5, np.pi]), true), true], here)
    assert len(placements) == 2
    assert placements.judge(room, scans, USUAL, CONFIG)
    assert placements.judge(room, scans, USUAL, CONFIG)
    assert not placements.judge(room, scans, USUAL, CONFIG)
    assert len(placements) == 1
    assert placements.best(here, 0) is None  # not at once
    best = placements.best(here, HELD_NS)
    assert best is not None
    np.testing.assert_allclose(geometry.compose(best.moved, here), true, atol=0.01)


def test_a_placement_is_looked_at_again_only_with_a_new_scan(room: Pyramid, monkeypatch: pytest.MonkeyPatch):
    """Nothing has changed without one. A new one begins the next round with the first placement."""
    looked = []
    monkeypatch.setattr(module, "refined", lambda _, __, moved, ___: looked.append(moved[0]) or moved)
    placements, scans = Placements(), kept(MOVED)
    placements.add([np.array([50.0 * k, 0.0, 0.0]) for k in (1, 2)], np.zeros(3))
    rounds = [placements.judge(room, each, USUAL, CONFIG) for each in (scans[:-1],) * 4 + (scans,) * 3]
    assert rounds == [True, True, False, False, True, True, False]
    assert looked == [50.0, 100.0, 50.0, 100.0]
    assert not Placements().judge(room, [], USUAL, CONFIG)


def test_places_near_one_that_is_tried_are_not_tried_again():
    """What searches find of one place is one placement."""
    placements = Placements()
    placements.add([HERE, ASIDE, ELSEWHERE], HERE)
    placements.add([HERE], HERE)
    assert len(placements) == 2


def test_a_placement_must_be_the_best_for_a_while():
    """Another one that comes first in between starts the time anew."""
    placements, (first, second) = tried(GOOD, GOOD._replace(misfit=0.2))
    assert placements.best(HERE, 0) is None
    assert placements.best(HERE, HELD_NS - 1) is None
    first.support, second.support = second.support, first.support
    assert placements.best(HERE, HELD_NS) is None
    first.support, second.support = second.support, first.support
    assert placements.best(HERE, HELD_NS + 1) is None
    assert placements.best(HERE, 2 * HELD_NS) is None
    assert placements.best(HERE, 2 * HELD_NS + 1) is first


@pytest.mark.parametrize(
    ("lacking", "why"),
    [
        (GOOD._replace(known=EVIDENCE - 0.1, agreeing=EVIDENCE - 0.1), "too little is known there"),
        (GOOD._replace(agreeing=(MOST - 0.01) * 8.0), "too many scans do not agree"),
        (GOOD._replace(spread=SPREAD - 0.1), "they were made at one place"),
        (GOOD._replace(crossing=CROSSING + 0.01), "too many beams cross walls"),
    ],
)
def test_a_placement_needs_scans_from_places_apart_that_agree(lacking: Support, why: str):
    """Alone, and yet not the one."""
    assert chosen(tried(GOOD)[0]) is not None
    assert chosen(tried(lacking)[0]) is None, why


def test_no_placement_is_the_one_beside_another_that_fits_nearly_as_well():
    """One of less than twice the misfit is a rival; others are none."""
    assert chosen(tried(GOOD, GOOD._replace(misfit=0.09))[0]) is None
    placements, (first, _) = tried(GOOD, GOOD._replace(misfit=0.11))
    assert chosen(placements) is first
    for contradicted in (GOOD._replace(agreeing=3.0), GOOD._replace(crossing=UNLIKELY + 0.01)):
        placements, (first, _) = tried(GOOD, contradicted._replace(misfit=0.06))
        assert chosen(placements) is first
    unproven = GOOD._replace(misfit=0.01, known=1.0, agreeing=1.0)
    placements, (first, _) = tried(GOOD, unproven)
    assert chosen(placements) is first


def test_whether_the_map_may_explain_a_local_map_shows_once_enough_is_known():
    """Before that nothing speaks for a placement."""
    assert tried(GOOD._replace(known=EVIDENCE - 0.1), GOOD)[0].any_supported
    assert not tried(GOOD._replace(known=EVIDENCE - 0.1))[0].any_supported


def test_a_robot_that_stands_is_found_by_the_place_where_it_stood():
    """One scan may do for that, if it agrees there."""
    stood = GOOD._replace(known=0.9, agreeing=0.9, spread=0.0)
    placements, (placement, _) = tried(stood, GOOD)
    assert placements.at(HERE, HERE, 0.15, 0.15) is placement
    assert placements.at(ASIDE, HERE, 0.15, 0.15) is None
    placement.support = stood._replace(agreeing=0.0)
    assert placements.at(HERE, HERE, 0.15, 0.15) is None
    placement.support = NOTHING
    assert placements.at(HERE, HERE, 0.15, 0.15) is None


def test_what_misses_walls_in_usual_scans_is_no_misfit(room: Pyramid) -> None:
    """Beyond MISSES: so much noise all placements have in common."""
    off = geometry.compose(MOVED, np.array([0.0, 0.5, 0.0]))
    clean, noisy = (support(room, kept(MOVED), off, USUAL._replace(hit=hit)) for hit in (1.0 - MISSES, 0.8))
    assert clean.misfit - noisy.misfit == pytest.approx(0.2 - MISSES)
    assert support(room, kept(MOVED), MOVED, USUAL._replace(hit=0.5)).misfit == 0.0
