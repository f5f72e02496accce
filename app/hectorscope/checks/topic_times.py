"""When the messages of one topic were stamped and recorded: rate, gaps, jitter, order, and how its clock runs."""

from array import array
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from slam_core.batches import SOON
from slam_core.measurements import Float64s, Int64s

FEWEST = 10  # messages: of fewer nothing is said
BUCKETS = 100  # parts of a recording, of each of which the fastest delivery counts
NEIGHBOURS = 5  # parts on each side of a step that show both levels


class Gap(NamedTuple):
    """log_ns: when it begins, as recorded. together: messages that came at once at its end."""

    log_ns: int
    seconds: float
    together: int


class Times:
    """Takes the messages of a topic in the order of recording. frames: of their headers."""

    def __init__(self) -> None:
        self._log, self._stamps = array("q"), array("q")
        self.frames: set[str] = set()

    def add(self, log_ns: int, stamp_ns: int | None, lasts_ns: int) -> None:
        """One message. lasts_ns: how long after its stamp the measurement ended."""
        self._log.append(log_ns)
        if stamp_ns is not None:
            self._stamps.extend((log_ns, stamp_ns, lasts_ns))

    @property
    def result(self) -> "TopicTimes":
        """Of all so far."""
        return TopicTimes(np.array(self._log, np.int64), np.array(self._stamps, np.int64).reshape(-1, 3))


@dataclass(frozen=True, eq=False)
class TopicTimes:
    """log_ns: (n,) when messages were recorded.

    stamped: (m, 3) of those with a stamp: when they were recorded, the stamp, how long they last; nanoseconds.
    """

    log_ns: Int64s
    stamped: Int64s

    @property
    def rate_hz(self) -> float:
        """The mean by the recorder's clock; nan for fewer than two messages."""
        span = self.log_ns[-1] - self.log_ns[0] if len(self.log_ns) > 1 else 0
        return (len(self.log_ns) - 1) / (float(span) * 1e-9) if span > 0 else float("nan")

    @property
    def longest_gap_s(self) -> float:
        """Between two messages, as recorded."""
        return float(np.diff(self.log_ns).max()) * 1e-9 if len(self.log_ns) > 1 and self.rate_hz > 0.0 else np.nan

    @cached_property
    def period_s(self) -> float:
        """The median interval of the stamps, of the recorder's times without any."""
        times = self.stamped[:, 1] if len(self.stamped) else self.log_ns
        return float(np.median(np.diff(times))) * 1e-9 if len(times) > 1 else float("nan")

    def gaps(self, at_least_s: float) -> list[Gap]:
        """The intervals that stamps and recorder both show, in order."""
        if len(self.stamped) < FEWEST:
            log_ns, apart = self.log_ns, np.diff(self.log_ns)
        else:
            log_ns, apart = self.stamped[:, 0], np.diff(self.stamped[:, :2], axis=0).min(axis=1)
        soon = np.append(apart < SOON * 1e9 * self.period_s, False)
        return [
            Gap(int(log_ns[i]), float(apart[i]) * 1e-9, 1 + int(np.argmin(soon[i + 1 :])))
            for i in np.flatnonzero(apart >= 1e9 * at_least_s).tolist()
        ]

    @property
    def jitter_s(self) -> float:
        """Nine of ten intervals between stamps are within this of their median."""
        if len(self.stamped) < FEWEST:
            return float("nan")
        return float(np.quantile(np.abs(np.diff(self.stamped[:, 1]) * 1e-9 - self.period_s), 0.9))

    @property
    def backwards(self) -> Int64s:
        """(k,) when messages were recorded that are stamped before an earlier one."""
        stamps = self.stamped[:, 1]
        late: Int64s = self.stamped[:, 0][stamps < np.maximum.accumulate(stamps)] if len(stamps) else stamps
        return late

    @cached_property
    def delays(self) -> tuple[Float64s, Float64s]:
        """(k,) seconds since the earliest message, and (k,) the fastest delivery around then.

        A delivery lasts from the end of a measurement to when it was recorded: what varies is the way, what stays
        is the difference of the clocks and the shortest way.
        """
        log_ns, stamps, lasts = self.stamped.T
        since = (log_ns - log_ns.min()) * 1e-9  # in a damaged file they are in any order
        whole = float(since.max())
        delay = (log_ns - stamps - lasts) * 1e-9
        parts = max(1, min(BUCKETS, len(since) // FEWEST))
        which = np.minimum((since / max(whole, 1e-9) * parts).astype(np.int64), parts - 1)
        fastest = np.full(parts, np.inf)
        np.minimum.at(fastest, which, delay)
        there = np.isfinite(fastest)
        middles = (np.arange(parts) + 0.5) * (whole / parts)
        return middles[there], fastest[there]

    @property
    def delay_s(self) -> float:
        """The fastest delivery of all; below zero for stamps ahead of the recorder's clock."""
        return float(self.delays[1].min()) if len(self.stamped) >= FEWEST else float("nan")

    @property
    def lasts_s(self) -> float:
        """How long a measurement lasts, in the median."""
        return float(np.median(self.stamped[:, 2])) * 1e-9 if len(self.stamped) else 0.0

    @property
    def shortest_s(self) -> float:
        """From a stamp to when its message was recorded, at least."""
        return float((self.stamped[:, 0] - self.stamped[:, 1]).min()) * 1e-9 if len(self.stamped) else float("nan")

    @cached_property
    def step(self) -> tuple[int, float] | None:
        """(when as recorded, seconds) of the largest lasting change of the delay from one part to the next."""
        middles, fastest = self.delays
        if len(fastest) < 2 * NEIGHBOURS:
            return None
        changes = np.abs(np.diff(fastest))
        at = 1 + int(np.argmax(changes))
        before, after = fastest[max(0, at - NEIGHBOURS) : at], fastest[at : at + NEIGHBOURS]
        change = float(np.median(after) - np.median(before))
        if abs(change) < 0.5 * float(changes[at - 1]) or float(changes[at - 1]) < 5.0 * float(np.median(changes)):
            return None
        return int(self.stamped[:, 0].min() + 1e9 * 0.5 * float(middles[at - 1] + middles[at])), change

    @cached_property
    def drift(self) -> float:
        """Seconds by which the delay grows a second: the median slope (Theil and Sen)."""
        seconds, fastest = self.delays
        i, j = np.triu_indices(len(seconds), 1)
        return float(np.median((fastest[j] - fastest[i]) / (seconds[j] - seconds[i]))) if len(i) else 0.0
