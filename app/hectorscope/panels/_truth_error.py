"""How far each pose is from the truth, as rows that charts draw."""

import numpy as np
from numpy.typing import NDArray

from hectorscope.session.snapshot import Snapshot
from slam_core.evaluation.trajectory import Trajectory, interpolate, move

ERROR_DTYPE = np.dtype([("time_s", "f8"), ("error", "f8"), ("error_z", "f8"), ("error_yaw", "f8")])
ERROR_COLUMNS = ERROR_DTYPE.names or ()


def truth_error(snapshot: Snapshot, first: int = 0) -> NDArray[np.void]:
    """(n,) of ERROR_DTYPE, metres and radians: one row a pose from `first` on, NaN without a truth.

    The truth lies in the map as the scene shows it, with its first pose on the first one of the run.
    """
    ours = Trajectory.from_rows(snapshot.trajectory[first:])
    rows = np.full(len(ours), np.nan, ERROR_DTYPE)
    rows["time_s"] = ours.times
    if not len(ours) or not len(snapshot.truth):
        return rows
    truth, covered = interpolate(Trajectory.from_rows(snapshot.truth), ours.times)
    x, y, z, yaw = snapshot.truth_in_map
    there, here = move(np.array([x, y, yaw]), truth.planar), ours.select(covered)
    difference = here.planar - there
    rows["error"][covered] = np.hypot(difference[:, 0], difference[:, 1])
    rows["error_yaw"][covered] = np.angle(np.exp(1j * difference[:, 2]))
    if np.ptp(snapshot.trajectory[:, 3]):  # a planar run has no height
        rows["error_z"][covered] = here.positions[:, 2] - (truth.positions[:, 2] + z)
    return rows
