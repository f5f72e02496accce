"""When a direction that few beams fix counts as unobservable."""

from itertools import cycle

import numpy as np
import pytest

from slam_core.config import SlamConfig, with_value
from slam_core.localization.weak_direction import WeakDirection
from slam_core.results import FEW, MatchResult

SCAN_NS = 75_000_000
STEP = 0.06  # metres from one scan to the next
LOOSE, FIRM = 0.03, 0.3  # shares of the beams
TO_AND_FRO = (0.06, -0.06)


def matched(x: float, share: float) -> MatchResult:
    """A match along the x axis, which is its weakest direction."""
    covariance = np.diag([1e-4, 1e-6, 1e-6])
    pose, nothing = np.array([x, 0.0, 0.0]), np.zeros((0, 4))
    return MatchResult(pose, covariance, np.eye(3), np.zeros(1), (1,), True, nothing, np.zeros(2), share)


def followed(weak, offsets, share=LOOSE, steps=STEP, begin=0, lapse_ns=SCAN_NS):
    """Scan numbers at which a direction begins to be held. offsets: of the matches from the robot, metres.

    steps: metres that the robot moves from scan to scan.
    """
    found, x = [], begin * STEP
    steps = np.broadcast_to(steps, len(offsets))
    for k, offset in enumerate(offsets, begin):
        x += steps[k - begin]
        match = matched(x + offset, share)
        if weak.begins(match, k * lapse_ns, lapse_ns):
            found.append(k)
        weak.moved(k * lapse_ns, match.pose)
    return found


def offsets(n, of=TO_AND_FRO):
    """That many, again and again the same."""
    return [offset for offset, _ in zip(cycle(of), range(n), strict=False)]


def test_matches_that_scatter_where_few_beams_fix_the_way():
    """It begins half a second after they do, once; the speed is the mean one; it ends with enough beams."""
    weak = WeakDirection()
    assert followed(weak, [0.0] * 20, FIRM) == []
    (begun,) = followed(weak, offsets(20), begin=20)
    assert 25 <= begun <= 28 and weak.held
    assert weak.speed * weak.direction[0] == pytest.approx(STEP / (SCAN_NS * 1e-9), rel=0.05)
    followed(weak, [0.0], FIRM, begin=40)
    assert not weak.held


def test_a_released_direction_is_held_when_matches_scatter_anew():
    """Not by the scatter before: five scans later at least."""
    weak, scan = WeakDirection(), 20
    followed(weak, [0.0] * 20, FIRM)
    while not weak.held:
        followed(weak, [TO_AND_FRO[scan % 2]], begin=scan)
        scan += 1
    weak.release()
    assert not weak.held
    (again,) = followed(weak, offsets(20, TO_AND_FRO[:: 1 if scan % 2 == 0 else -1]), begin=scan)
    assert again - scan >= 5


@pytest.mark.parametrize("direction", [(1.0, 0.0), (0.0, 1.0), (0.0, -1.0)])
def test_the_sign_of_an_axis_turns_no_speed_round(direction):
    """The velocity that is kept stays the same along an axis whose sign may change from one match to the next."""
    weak, along = WeakDirection(), np.array(direction)
    turned = np.array([[along[0], -along[1]], [along[1], along[0]]])
    for k, offset in enumerate(offsets(40)):
        tilt = 1e-9 * (-1) ** k  # puts the axis on either side of where its sign changes
        covariance = np.eye(3) * 1e-6
        covariance[:2, :2] = turned @ np.array([[1e-4, tilt], [tilt, 1e-6]]) @ turned.T
        pose = np.array([*((k * STEP + offset) * along), 0.0])
        weak.begins(matched(0.0, LOOSE)._replace(pose=pose, covariance=covariance), k * SCAN_NS, SCAN_NS)
        weak.moved(k * SCAN_NS, pose)
        if weak.held:
            np.testing.assert_allclose(weak.speed * weak.direction, STEP / (SCAN_NS * 1e-9) * along, atol=0.1)
    assert weak.held


@pytest.mark.parametrize(
    ("what", "of", "share", "lapse_ns"),
    [
        ("enough beams", TO_AND_FRO, FIRM, SCAN_NS),
        ("a single jump now and then", (0.0,) * 9 + (0.2,), LOOSE, SCAN_NS),
        ("a slow scanner", (0.7, -0.7, 0.0), LOOSE, 250_000_000),
    ],
)
def test_nothing_begins_for_other_reasons(what, of, share, lapse_ns):
    """Each of them alone keeps the direction observable."""
    assert followed(WeakDirection(), offsets(60, of), share, lapse_ns=lapse_ns) == [], what


def test_an_acceleration_is_no_scatter():
    """Each step is longer than the one before, by as much."""
    assert followed(WeakDirection(), [0.0] * 60, steps=0.06 * np.arange(60)) == []


def test_stamps_that_jitter_are_no_scatter():
    """The step to a scan is compared with the time that it took."""
    weak, now_ns = WeakDirection(), 0
    for k in range(60):
        lapse_ns = SCAN_NS + 30_000_000 * (-1) ** k
        now_ns += lapse_ns
        match = matched(STEP / SCAN_NS * now_ns, LOOSE)
        assert not weak.begins(match, now_ns, lapse_ns)
        weak.moved(now_ns, match.pose)


def test_matches_that_always_scatter_are_usual():
    """Where a laser sways, they do so with enough beams as well: twice as much has to be new."""
    weak = WeakDirection()
    followed(weak, offsets(100), FIRM)
    assert followed(weak, offsets(40), begin=100) == []


def test_less_than_a_robot_accelerates_is_no_scatter():
    """Also where matches are usually sure to a millimetre."""
    weak = WeakDirection()
    followed(weak, [0.0] * 100, FIRM)
    assert followed(weak, offsets(40, (0.005, -0.005)), begin=100) == []
    assert followed(weak, offsets(40, (0.01, -0.01)), begin=140)


def test_a_robot_that_starts_has_no_speed_to_keep():
    """The direction is held only once the speed before has been the same for a time."""
    steps = np.r_[np.zeros(10), np.full(40, STEP)]
    (begun,) = followed(WeakDirection(), [0.0] * 10 + offsets(40), steps=steps)
    assert 20 < begun < 35  # at once it would be scan 17


@pytest.mark.parametrize("lapse_ns", [-19 * SCAN_NS, 0, 2_000_000_000])
def test_a_gap_or_a_clock_that_is_set_back_ends_it(lapse_ns):
    """What was before is no speed of now."""
    weak = WeakDirection()
    assert followed(weak, offsets(20))
    now_ns = 19 * SCAN_NS + lapse_ns
    assert not weak.begins(matched(0.0, LOOSE), now_ns, lapse_ns)
    assert not weak.held


def test_few_beams_count_as_none_while_it_is_held():
    """The threshold of the matcher rises to that, and is never lowered."""
    weak, config = WeakDirection(), SlamConfig()
    assert weak.configured(config) is config
    followed(weak, offsets(20))
    assert weak.configured(config).matcher.degeneracy_threshold == FEW
    higher = with_value(config, "matcher.degeneracy_threshold", 0.15)
    assert weak.configured(higher) == higher
