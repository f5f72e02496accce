"""What became of a variant: how far off it was, and whether the map was written there."""

import numpy as np

from benchmarks.ensembles import LOST_SCANS, Outcome, Run, outcomes

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
