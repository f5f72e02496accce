"""Measurements that were not used as they came: reasons, and counts by reason and source."""

from collections import Counter
from collections.abc import Mapping

from slam_core.results import AidingStatus

WEIGHTLESS = "start without gravity in the accelerometers"
SET_BACK = "clock set back"
LEAPT = "clock set ahead"
UNUSABLE = "correction without a usable value"
TOO_OLD = "correction older than the history"
TOO_EARLY = "correction before the attitude was known"
FAR_AHEAD = "stamp far ahead"
NOT_LATER = "inertial sample not later than the one before"
GAP = "gap in the inertial data"
SLIPPED = "wheel velocity while the wheels slip"


class Rejections:
    """counts: by reason, over all sources and the inertial data."""

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()
        self._dropped: dict[str, Mapping[str, int]] = {}  # replaced, never changed: statuses hold them

    def drop(self, source: str, reason: str) -> None:
        """Count a measurement of a source that cannot be used."""
        self.counts[reason] += 1
        reasons = self._dropped.get(source, {})
        self._dropped[source] = {**reasons, reason: reasons.get(reason, 0) + 1}

    def statuses(self, gated: Mapping[str, AidingStatus]) -> tuple[AidingStatus, ...]:
        """The status of every source: gated by their gates, with what was dropped before it came to one."""
        if not self._dropped:
            return tuple(gated.values())
        both = dict(gated)
        for source, reasons in self._dropped.items():
            status = gated.get(source) or AidingStatus(source)
            both[source] = AidingStatus._make((*status[:-1], reasons))  # all but what was dropped
        return tuple(both.values())
