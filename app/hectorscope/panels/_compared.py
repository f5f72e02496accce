"""What the shown and the compared run differ in, as rows that charts draw: one a scan of the compared run."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hectorscope.panels._truth_error import truth_error
from hectorscope.session.snapshot import Compared, Snapshot

APART_COLUMNS = ("time_s", "apart", "apart_z", "apart_yaw", "sigma_shown", "sigma_compared")
ERRORS_COLUMNS = ("time_s", "error_shown", "error_compared")
MAPS_COLUMNS = ("time_s", "map_apart")

Rows = NDArray[np.float64]


def apart_rows(snapshot: Snapshot, compared: Compared, first: int) -> Rows:
    """(n, len(APART_COLUMNS)) from row `first` on, metres, radians; NaN for a scan that the shown run left out."""
    theirs, known = compared.series[first:], snapshot.ahead.series
    if not len(theirs) or not len(known):
        return np.empty((0, len(APART_COLUMNS)))
    ours = known[_places(known["time_s"], theirs["time_s"])]
    rows = np.stack(
        [
            theirs["time_s"],
            np.hypot(ours["x"] - theirs["x"], ours["y"] - theirs["y"]),
            ours["z"] - theirs["z"],
            np.angle(np.exp(1j * (ours["yaw"] - theirs["yaw"]))),
            np.hypot(ours["fused_sigma_x"], ours["fused_sigma_y"]),
            np.hypot(theirs["fused_sigma_x"], theirs["fused_sigma_y"]),
        ],
        axis=1,
    )
    rows[ours["time_s"] != theirs["time_s"], 1:] = np.nan
    return rows


def errors_rows(snapshot: Snapshot, compared: Compared, first: int) -> Rows:
    """(n, len(ERRORS_COLUMNS)) from row `first` on, metres, as far as the truth covers them."""
    theirs = truth_error(_as_shown(snapshot, compared), first)
    covered = np.flatnonzero(np.isfinite(theirs["error"]))
    theirs = theirs[: covered[-1] + 1 if len(covered) else 0]
    if not len(theirs):
        return np.empty((0, len(ERRORS_COLUMNS)))
    ours = truth_error(snapshot, int(np.searchsorted(snapshot.trajectory[:, 0], theirs["time_s"][0])))
    if not len(ours):
        return np.empty((0, len(ERRORS_COLUMNS)))
    at = _places(ours["time_s"], theirs["time_s"])
    known = np.where(ours["time_s"][at] == theirs["time_s"], ours["error"][at], np.nan)
    return np.stack([theirs["time_s"], known, theirs["error"]], axis=1)


def _places(times: Rows, wanted: Rows) -> NDArray[np.intp]:
    """Where each wanted time is among times, or where it would be."""
    return np.minimum(np.searchsorted(times, wanted), len(times) - 1)


def _as_shown(snapshot: Snapshot, compared: Compared) -> Snapshot:
    """The compared run in the place of the shown one."""
    return replace(snapshot, trajectory=compared.trajectory, truth_in_map=compared.truth_in_map)
