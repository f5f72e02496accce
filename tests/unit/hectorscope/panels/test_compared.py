"""What two runs differ in, as rows for the charts."""

from dataclasses import replace

import numpy as np

from hectorscope.panels._compared import APART_COLUMNS, apart_rows, errors_rows
from hectorscope.panels.plots import compared_tables
from hectorscope.run.series import SERIES_DTYPE
from hectorscope.run.settings import Settings
from hectorscope.session.snapshot import Ahead, Compared, Snapshot
from tests.page import room_snapshot


def series(snapshot: Snapshot, x: float) -> np.ndarray:
    """Rows of the trajectory with everything moved by x metres, and some covariance."""
    rows = np.zeros(len(snapshot.trajectory), SERIES_DTYPE)
    rows["time_s"], rows["x"] = snapshot.trajectory[:, 0], snapshot.trajectory[:, 1] + x
    rows["fused_sigma_x"], rows["yaw"] = 0.003 + x, 3.1 + x
    return rows


def shown(x: float) -> Snapshot:
    """A run, and another one that is x metres beside it."""
    snapshot = room_snapshot()
    moved = snapshot.trajectory + np.array([0, x, 0, 0, 0, 0, 0, 0])
    other = Compared(1, "other", Settings(), True, moved, np.zeros(4), series(snapshot, x), None)
    return replace(snapshot, ahead=Ahead(series=series(snapshot, 0.0)), compared=other)


def rows(snapshot: Snapshot, first: int = 0) -> dict[str, np.ndarray]:
    """By the names of the columns."""
    assert snapshot.compared is not None
    return dict(zip(APART_COLUMNS, apart_rows(snapshot, snapshot.compared, first).T, strict=True))


def test_runs_that_are_the_same_are_not_apart() -> None:
    """Zero at every scan."""
    assert not rows(shown(0.0))["apart"].any()


def test_the_distance_is_that_at_the_same_time() -> None:
    """In position, and in heading the short way round; each has its own covariance."""
    found = rows(shown(0.5))
    assert np.allclose(found["apart"], 0.5)
    assert np.allclose(found["apart_yaw"], -0.5)
    assert np.allclose(found["sigma_shown"], 0.003) and np.allclose(found["sigma_compared"], 0.503)


def test_rows_are_sent_from_one_on() -> None:
    """Those from there are the last of all."""
    whole, part = rows(shown(0.5)), rows(shown(0.5), 30)
    assert np.array_equal(part["time_s"], whole["time_s"][30:])


def test_a_scan_that_one_run_left_out_has_no_distance() -> None:
    """There is nothing to compare it with; the others have theirs."""
    snapshot = shown(0.5)
    without = np.delete(snapshot.ahead.series, 7)
    found = rows(replace(snapshot, ahead=Ahead(series=without)))["apart"]
    assert np.isnan(found[7]) and np.isfinite(np.delete(found, 7)).all()


def test_both_errors_are_against_the_same_truth() -> None:
    """The truth is 0.1 m beside the shown run."""
    snapshot = shown(0.5)
    assert snapshot.compared is not None
    found = errors_rows(snapshot, snapshot.compared, 0)
    assert len(found) and np.allclose(found[:, 1], 0.1) and np.allclose(found[:, 2], np.hypot(0.5, 0.1))


def test_without_a_comparison_there_are_no_rows() -> None:
    """Those that a page has are taken away."""
    assert [len(give(0)) for give in compared_tables(room_snapshot()).values()] == [0, 0, 0]
