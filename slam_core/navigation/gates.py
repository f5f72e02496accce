"""Gates: whether a measurement is used, the status of each source, and how a rejected source comes back.

The test: the normalised innovation squared, nu^T S^-1 nu, against the chi-square bound of its dimension. A filter
whose covariance is too small would reject the truth for good. So a source whose rejections agree with
each other for a while comes back: the filter raises the covariance of the states that this source measures
and that no other has measured meanwhile. What others measure stays: a satellite position that contradicts the
matches moves nothing, one that contradicts dead reckoning does.
"""

import math
from collections.abc import Iterable, Mapping

import numpy as np

from slam_core.measurements import Float64s
from slam_core.navigation.corrections import Correction, Update
from slam_core.results import AidingStatus

Statuses = Mapping[str, AidingStatus]
"""By source; replaced, never changed."""

LEAST_STREAK = 3  # rejections in a row: fewer may be outliers
# A sensor that repeats a value for so long, and over so much way, is frozen.
FROZEN_NS = 5_000_000_000
FROZEN_DISTANCE = 2.0  # m


def fuse(
    x: Float64s, P: Float64s, statuses: Statuses, stamp_ns: int, correction: Correction, reset_time_ns: int
) -> tuple[Float64s, Float64s, Statuses]:
    """The estimate after a correction, or as it was if that is rejected, and the status of every source."""
    old = statuses.get(correction.source) or AidingStatus(correction.source, correction.measures)
    old = _read(old, stamp_ns, correction.reading, x)
    if old.frozen:
        return x, P, {**statuses, correction.source: old}
    update = correction.update(x, P)
    streak, streak_ns, returned = 0, 0, False
    if not update.accepted:
        streak, streak_ns = (old.streak + 1, old.streak_ns) if _agree(old, update) else (1, stamp_ns)
        if streak >= LEAST_STREAK and stamp_ns - streak_ns >= reset_time_ns:
            open_states = _measured_by_no_other(old, statuses.values(), stamp_ns - reset_time_ns)
            update = correction.update(x, _with_error(P, *correction.observe(x)[:2], open_states))
            returned = update.accepted
    used = update.accepted
    status = AidingStatus(  # by place, as it is made for every measurement: by name takes twice as long
        old.source, old.measures, old.used + used, old.rejected + (not used), old.returns + returned,
        stamp_ns, update.innovation, update.S, update.nis, update.bound,
        stamp_ns if used else old.used_ns, 0 if used else streak, 0 if used else streak_ns,
        old.reading, old.reading_ns, old.reading_at,
    )  # fmt: skip
    if used:
        x, P = update.x, update.P
    return x, P, {**statuses, correction.source: status}


def _read(old: AidingStatus, stamp_ns: int, reading: tuple[float, ...], x: Float64s) -> AidingStatus:
    """Whether a reading is frozen: to the last bit the same while the base went on, and for a while."""
    if not reading:
        return old
    here = x[4:7]
    if reading != old.reading:
        return old._replace(reading=reading, reading_ns=stamp_ns, reading_at=tuple(here.tolist()), frozen=False)
    lasting = stamp_ns - old.reading_ns >= FROZEN_NS
    if lasting and math.dist(here, old.reading_at) >= FROZEN_DISTANCE:
        return old._replace(stamp_ns=stamp_ns, rejected=old.rejected + 1, frozen=True)
    return old


def _agree(old: AidingStatus, update: Update) -> bool:
    """Whether two innovations in a row were rejected and differ no more than one may differ from zero."""
    if not old.streak or len(old.innovation) != len(update.innovation):
        return False
    apart = update.innovation - old.innovation
    return float(apart @ np.linalg.solve(update.S, apart)) <= update.bound


def _measured_by_no_other(status: AidingStatus, others: Iterable[AidingStatus], since_ns: int) -> list[int]:
    """The states that a source measures and no other has been used for since then."""
    measured: set[int] = set()
    for other in others:
        if other.source != status.source and other.used and other.used_ns >= since_ns:
            measured.update(other.measures)
    return [state for state in status.measures if state not in measured]


def _with_error(P: Float64s, innovation: Float64s, C: Float64s, states: list[int]) -> Float64s:
    """P with the innovation as an error of some states: as large as the contradiction is."""
    error = np.zeros(len(P))
    error[states] = np.linalg.pinv(C[:, states]) @ innovation
    return P + np.outer(error, error)
