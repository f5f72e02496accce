"""The last seconds of the filter: a late measurement is applied at its own time, and all after it again.

The belief is a function of what was measured, whatever order it came in.
"""

from bisect import bisect_left
from typing import NamedTuple

from slam_core.aiding import Correction
from slam_core.gates import Statuses, fuse
from slam_core.measurements import Float64s
from slam_core.strapdown import Strapdown

KEPT_NS = 1_500_000_000
# Between two inertial samples further apart than this, or this long after the last, the motion is unknown.
MAX_GAP_NS = 200_000_000


class Entry(NamedTuple):
    """The belief at one instant, the input since the entry before, and the correction applied at the end."""

    stamp_ns: int
    u: Float64s | None
    correction: Correction | None
    x: Float64s
    P: Float64s
    statuses: Statuses


def _stamp(entry: Entry) -> int:
    return entry.stamp_ns


class History:
    """Entries in order of time; the first is where everything starts, the last is the newest belief."""

    def __init__(self, stamp_ns: int, sample: Float64s, x: Float64s, P: Float64s) -> None:
        self.sample_ns = stamp_ns
        self._sample = sample
        self._entries = [Entry(stamp_ns, None, None, x, P, {})]
        self._asked: tuple[int, Entry, Float64s | None, Strapdown] | None = None
        self._answer = x, P

    def copy(self) -> "History":
        """An independent copy; entries are never changed, so they are shared."""
        other = History.__new__(History)
        other.sample_ns, other._sample = self.sample_ns, self._sample
        other._entries = self._entries.copy()
        other._asked, other._answer = self._asked, self._answer
        return other

    @property
    def newest(self) -> Entry:
        """The latest belief."""
        return self._entries[-1]

    def at(self, time_ns: int, model: Strapdown) -> tuple[int, Float64s, Float64s]:
        """(stamp, x, P) predicted to an instant; the oldest belief for an instant before it."""
        entry, u = self._around(time_ns)
        if time_ns <= entry.stamp_ns:
            return entry.stamp_ns, entry.x, entry.P
        return time_ns, *self._predict(time_ns, entry, u, model)

    def state_at(self, time_ns: int, model: Strapdown) -> Float64s:
        """As `at`, but x alone."""
        entry, u = self._around(time_ns)
        dt = (time_ns - entry.stamp_ns) * 1e-9
        return entry.x if dt <= 0.0 else model.move(entry.x, u, dt)

    def add_sample(self, stamp_ns: int, sample: Float64s, model: Strapdown) -> None:
        """Predict on to an inertial sample later than the last one: its interval holds the mean of both."""
        known = stamp_ns - self.sample_ns <= MAX_GAP_NS
        u = 0.5 * (self._sample + sample) if known else None
        ahead = self._take_ahead()
        self.sample_ns, self._sample = stamp_ns, sample
        for entry in ahead:
            if entry.stamp_ns <= stamp_ns:
                self._push(entry.stamp_ns, u, entry.correction, model)
        self._push(stamp_ns, u, None, model)
        for entry in ahead:
            if entry.stamp_ns > stamp_ns:
                self._push(entry.stamp_ns, self._held(entry.stamp_ns), entry.correction, model)
        self._forget()

    def add_correction(self, stamp_ns: int, correction: Correction, model: Strapdown) -> bool:
        """Apply a correction at its time and predict on through what came after; False if it is too old."""
        i = self._later_than(stamp_ns)
        if i == 0:
            return False
        later = self._take(i)
        self._push(stamp_ns, later[0].u if later else self._held(stamp_ns), correction, model)
        for entry in later:
            self._push(entry.stamp_ns, entry.u, entry.correction, model)
        return True

    def _around(self, time_ns: int) -> tuple[Entry, Float64s | None]:
        """The entry at or before an instant, and the input that holds from there."""
        i = self._later_than(time_ns)
        u = self._entries[i].u if i < len(self._entries) else self._held(time_ns)
        return self._entries[max(i - 1, 0)], u

    def _later_than(self, time_ns: int) -> int:
        """Index of the first entry later than an instant, from the newest on: nearly always one of the last."""
        i = len(self._entries)
        while i and self._entries[i - 1].stamp_ns > time_ns:
            i -= 1
        return i

    def _held(self, time_ns: int) -> Float64s | None:
        """The input after the last sample: that sample, for a while."""
        return self._sample if time_ns - self.sample_ns <= MAX_GAP_NS else None

    def _take_ahead(self) -> list[Entry]:
        """Take the corrections later than the last sample; mostly there are none."""
        first = len(self._entries)
        while self._entries[first - 1].stamp_ns > self.sample_ns:
            first -= 1
        return self._take(first)

    def _take(self, first: int) -> list[Entry]:
        taken = self._entries[first:]
        del self._entries[first:]
        return taken

    def _push(self, stamp_ns: int, u: Float64s | None, correction: Correction | None, model: Strapdown) -> None:
        last = self._entries[-1]
        x, P = self._predict(stamp_ns, last, u, model)
        statuses = last.statuses
        if correction is not None:
            x, P, statuses = fuse(x, P, statuses, stamp_ns, correction, model.patience_ns)
        self._entries.append(Entry(stamp_ns, u, correction, x, P, statuses))

    def _predict(
        self, stamp_ns: int, entry: Entry, u: Float64s | None, model: Strapdown
    ) -> tuple[Float64s, Float64s]:
        """The belief at an instant after an entry; the last one is kept, as a scan asks for its own thrice."""
        asked, now = self._asked, (stamp_ns, entry, u, model)
        if (
            asked is None
            or asked[0] != stamp_ns
            or any(a is not b for a, b in zip(asked[1:], now[1:], strict=True))
        ):
            self._asked = now
            self._answer = model.advance(entry.x, entry.P, u, (stamp_ns - entry.stamp_ns) * 1e-9)
        return self._answer

    def _forget(self) -> None:
        """Drop what is too old, in large pieces since each costs a copy of the list."""
        if self.sample_ns - self._entries[0].stamp_ns > 2 * KEPT_NS:
            del self._entries[: bisect_left(self._entries, self.sample_ns - KEPT_NS, key=_stamp) - 1]
