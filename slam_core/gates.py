"""Whether a measurement is let into the filter, what is kept of each source, and how a rejected one comes back.

The test: the normalised innovation squared, nu^T S^-1 nu, against the chi-square bound of its dimension. A filter
that is surer of itself than it should be would reject the truth for good. So a source whose rejections agree with
each other for a while comes back: the filter gives up what it believes about the states that this source measures
and that no other has measured meanwhile. What others vouch for stays: a satellite position that contradicts the
matches moves nothing, one that contradicts dead reckoning does.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from slam_core.aiding import Correction, Update
from slam_core.measurements import Float64s
from slam_core.results import AidingStatus

Statuses = Mapping[str, AidingStatus]
"""By source; replaced, never changed."""

LEAST_STREAK = 3  # rejections in a row: fewer may be outliers


def fuse(
    x: Float64s, P: Float64s, statuses: Statuses, stamp_ns: int, correction: Correction, patience_ns: int
) -> tuple[Float64s, Float64s, Statuses]:
    """The belief after a correction, or as it was if that is rejected, and what is known of every source then."""
    update = correction.update(x, P)
    old = statuses.get(correction.source) or AidingStatus(correction.source, correction.measures)
    if update.accepted:
        status = _used(old, stamp_ns, update)
    else:
        status = _rejected(old, stamp_ns, update)
        if status.streak >= LEAST_STREAK and stamp_ns - status.streak_ns >= patience_ns:
            doubted = _unvouched(status, statuses.values(), stamp_ns - patience_ns)
            update = correction.update(x, _doubting(P, *correction.observe(x)[:2], doubted))
            if update.accepted:
                status = replace(_used(old, stamp_ns, update), returns=old.returns + 1)
    if update.accepted:
        x, P = update.x, update.P
    return x, P, {**statuses, correction.source: status}


def _used(old: AidingStatus, stamp_ns: int, update: Update) -> AidingStatus:
    return replace(_last(old, stamp_ns, update), used=old.used + 1, used_ns=stamp_ns, streak=0)


def _rejected(old: AidingStatus, stamp_ns: int, update: Update) -> AidingStatus:
    """One more rejection; the streak goes on if it says what the last one said."""
    agrees = old.streak > 0 and _agree(np.array(old.innovation), update)
    return replace(
        _last(old, stamp_ns, update),
        rejected=old.rejected + 1,
        streak=old.streak + 1 if agrees else 1,
        streak_ns=old.streak_ns if agrees else stamp_ns,
    )


def _last(old: AidingStatus, stamp_ns: int, update: Update) -> AidingStatus:
    return replace(
        old,
        stamp_ns=stamp_ns,
        innovation=tuple(update.innovation.tolist()),
        sigma=tuple(np.sqrt(np.diag(update.S)).tolist()),
        nis=update.nis,
        bound=update.bound,
    )


def _agree(before: Float64s, update: Update) -> bool:
    """Whether two innovations differ no more than one may differ from zero."""
    if len(before) != len(update.innovation):
        return False
    apart = update.innovation - before
    return float(apart @ np.linalg.solve(update.S, apart)) <= update.bound


def _unvouched(status: AidingStatus, others: Iterable[AidingStatus], since_ns: int) -> list[int]:
    """The states that a source measures and no other has been used for since then."""
    vouched: set[int] = set()
    for other in others:
        if other.source != status.source and other.used and other.used_ns >= since_ns:
            vouched.update(other.measures)
    return [state for state in status.measures if state not in vouched]


def _doubting(P: Float64s, innovation: Float64s, C: Float64s, doubted: list[int]) -> Float64s:
    """P with the innovation as an error of the doubted states: as unsure as the contradiction is large."""
    error = np.zeros(len(P))
    error[doubted] = np.linalg.pinv(C[:, doubted]) @ innovation
    return P + np.outer(error, error)
