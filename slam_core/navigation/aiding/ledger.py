"""What was not used as it came, by reason, and of which source."""

from collections import Counter
from collections.abc import Mapping

from slam_core.results import AidingStatus


class Ledger:
    """counts: by reason, over all sources and the inertial data."""

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()
        self._dropped: dict[str, Mapping[str, int]] = {}  # replaced, never changed: statuses hold them

    def copy(self) -> "Ledger":
        """An independent copy."""
        other = Ledger()
        other.counts = self.counts.copy()
        other._dropped = self._dropped.copy()
        return other

    def drop(self, source: str, reason: str) -> None:
        """Count a measurement of a source that is of no use."""
        self.counts[reason] += 1
        reasons = self._dropped.get(source, {})
        self._dropped[source] = {**reasons, reason: reasons.get(reason, 0) + 1}

    def told(self, statuses: Mapping[str, AidingStatus]) -> tuple[AidingStatus, ...]:
        """What became of the measurements of every source: what the gates say, and what never came to them."""
        if not self._dropped:
            return tuple(statuses.values())
        both = dict(statuses)
        for source, reasons in self._dropped.items():
            status = statuses.get(source) or AidingStatus(source)
            both[source] = AidingStatus._make((*status[:-1], reasons))  # all but what was dropped
        return tuple(both.values())
