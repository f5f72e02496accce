"""The claims of the filter against the truth, over a few drives."""

from benchmarks.consistency import CORRELATION, Drive, drive, hour, judge, speed

SEEDS = (1, 2)


def drives(method: str, correlation: float) -> list[Drive]:
    return [drive(seed, method, correlation) for seed in SEEDS]  # type: ignore[arg-type]


def test_a_kalman_update_is_honest_about_independent_errors() -> None:
    """The mean error is what the covariance says, of the whole state and of the pose."""
    runs = drives("kalman", 0.0)
    assert judge(runs, 1, 15).word == judge(runs, 2, 3).word == "consistent"


def test_correlated_matches_fool_the_kalman_update_and_not_the_intersection() -> None:
    """The same matches and claims: one takes them for news each time."""
    kalman, fixed = (judge(drives(method, CORRELATION), 2, 3) for method in ("kalman", "fixed"))
    assert kalman.word == "over-confident" and kalman.nees > 3.0
    assert fixed.word != "over-confident" and fixed.nees < 1.0


def test_what_the_filter_costs_is_measured() -> None:
    """A row each for the prediction, six corrections, and a stretch of samples, here of two seconds."""
    rows = speed(2).splitlines()[2:]
    assert len([row for row in rows if " us |" in row]) == 7
    assert any(row.startswith("| 2 s at 200 Hz") for row in rows)


def test_the_covariance_stays_one() -> None:
    """Half a minute at 200 Hz with matches: the least eigenvalue is positive all the time."""
    assert hour(30)[1] > 0.0
