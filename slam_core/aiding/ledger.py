"""What was not used as it came, by reason, and of which source."""

from collections import Counter
from collections.abc import Mapping

from slam_core.results import AidingStatus


class Ledger:
    """counts: by reason, over all sources and the inertial data."""

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()
        self._dropped: dict[str, Counter[str]] = {}
        # By source: its status without what was dropped, and with that; a status is asked for at every scan.
        self._told: dict[str, tuple[AidingStatus | None, AidingStatus]] = {}

    def copy(self) -> "Ledger":
        """An independent copy."""
        other = Ledger()
        other.counts = self.counts.copy()
        other._dropped = {source: reasons.copy() for source, reasons in self._dropped.items()}
        return other

    def drop(self, source: str, reason: str) -> None:
        """Count a measurement of a source that is of no use."""
        self.counts[reason] += 1
        self._dropped.setdefault(source, Counter())[reason] += 1
        self._told.pop(source, None)

    def told(self, statuses: Mapping[str, AidingStatus]) -> tuple[AidingStatus, ...]:
        """What became of the measurements of every source: what the gates say, and what never came to them."""
        both = dict(statuses)
        for source, reasons in self._dropped.items():
            status = statuses.get(source)
            if source not in self._told or self._told[source][0] is not status:
                whole = (status or AidingStatus(source))._replace(dropped=dict(reasons))
                self._told[source] = status, whole
            both[source] = self._told[source][1]
        return tuple(both.values())
