"""What became of a variant: how far off it was, and whether the map was written there."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.ensembles import LOST_SCANS, Outcome, Run, follow, outcomes, varied
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.config import SlamConfig
from slam_core.measurements import LaserScan

TIMES = np.arange(0.0, 60.0, 0.2)
TRUTH = np.column_stack([TIMES, np.zeros_like(TIMES), np.zeros_like(TIMES)])  # 1 m/s along x


def judged(along: np.ndarray, *, sure: bool = True) -> Outcome:
    """Of a run that is so many metres too far along x at each scan, and writes all of them."""
    poses = np.column_stack([TIMES, TRUTH + np.outer(along, [1.0, 0.0, 0.0])])
    (outcome,) = outcomes(
        [Run(poses, TRUTH, np.full(len(TIMES), sure), np.ones(len(TIMES), bool), lost_at_the_end=False)]
    )
    return outcome


def test_a_run_on_the_truth_has_nothing_to_count() -> None:
    """No error, nothing lost, no slide."""
    assert judged(np.zeros_like(TIMES)) == Outcome(0.0, 0.0, lost=False, misplaced=False, silent=False, slides=0)


def test_a_slide_counts_the_scans_whose_motion_it_spoils() -> None:
    """0.3 m off for four seconds: the motions that begin in the two seconds before either change."""
    outcome = judged(np.where((TIMES >= 30.0) & (TIMES < 34.0), 0.3, 0.0))
    assert outcome.slides == 20
    assert not (outcome.lost or outcome.misplaced or outcome.silent)


def test_scans_far_off_are_written_wrong_and_silent() -> None:
    """2 m off on the way, and sure of it; lost are those that are so at the end."""
    off = np.where((TIMES >= 30.0) & (TIMES < 34.0), 2.0, 0.0)
    outcome = judged(off)
    assert (outcome.misplaced, outcome.silent, outcome.lost) == (True, True, False)
    assert not judged(off, sure=False).silent
    off[-LOST_SCANS:] = 2.0
    assert judged(off).lost


def test_runs_that_begin_later_are_compared_at_the_same_times() -> None:
    """Without a truth: a variant that lacks the first scans and is right has no error."""
    turning = np.column_stack([TIMES, np.sin(TIMES / 5.0), np.cos(TIMES / 5.0), TIMES / 5.0])
    whole = Run(turning, None, np.ones(len(TIMES), bool), np.ones(len(TIMES), bool), lost_at_the_end=False)
    late = replace(whole, poses=turning[20:], sure=whole.sure[20:], written=whole.written[20:])
    for runs in ((whole, whole, late), (late, late, whole)):
        for outcome in outcomes(runs):
            assert outcome == Outcome(pytest.approx(0.0), pytest.approx(0.0), False, False, False, 0)


def test_times_count_from_the_start_of_the_recording() -> None:
    """Those of a variant as well, whose first scans are missing."""
    items = list(Simulation("rooms", SceneOptions(duration=6.0, scan_rate=5.0, beams=61, imu=False)).items())
    scans = [item for item in items if isinstance(item, LaserScan)]
    kept = [item for item in varied(items, 2) if isinstance(item, LaserScan)]
    assert len(kept) < len(scans)
    run = follow(kept, SlamConfig(), items[0].stamp_ns)
    first_s = (kept[0].stamp_ns - items[0].stamp_ns) * 1e-9
    assert first_s <= run.poses[0, 0] <= first_s + 0.2


def test_a_scan_that_is_sent_again_has_the_same_noise() -> None:
    """Also where a recording holds its ranges twice: a copy stays one in all variants."""
    scans = [LaserScan(k, np.full(9, 1.0 + k // 2, np.float32), 0.0, 0.1) for k in range(60)]
    ranges = {item.stamp_ns: item.ranges for item in varied(scans, 2) if isinstance(item, LaserScan)}
    assert all(np.array_equal(ranges[k], ranges[k + 1]) for k in range(30, 60, 2))
    assert not np.array_equal(ranges[31] + 1.0, ranges[32])
