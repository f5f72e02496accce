"""Which stamps are accepted: not a single one far ahead, but those of a clock that was set."""

from typing import NamedTuple

from slam_core.measurements import LEAP_NS

BACKWARDS = "time runs backwards: stamped before the message ahead of it"
AHEAD = "time leaps ahead: stamped far beyond the message ahead of it"
# Nothing is out of order by so much: it is by a clock that was set back.
SET_BACK_NS = 1_000_000_000
# So many that continue each other are accepted.
RUN_AHEAD, RUN_BACK = 2, 3


class _Moment(NamedTuple):
    stamp_ns: int
    receive_ns: int

    def leads_to(self, later: "_Moment") -> bool:
        """Whether time goes on from here, and no further than the silence in between explains."""
        silence_ns = max(0, later.receive_ns - self.receive_ns)
        return 0 <= later.stamp_ns - self.stamp_ns <= LEAP_NS + silence_ns


class Stamps:
    """The stamps of one topic, in order of arrival. repeats: whether one may come again."""

    def __init__(self, *, repeats: bool = True) -> None:
        self._repeats = repeats
        self._accepted: _Moment | None = None
        self._candidate: _Moment | None = None
        self._run = 0

    def fault(self, stamp_ns: int, receive_ns: int = 0) -> str:
        """Why the next message is left out; empty if it is not. receive_ns: when it came, if that is known."""
        now, accepted = _Moment(stamp_ns, receive_ns), self._accepted
        if accepted is not None and not self._follows(accepted, now):
            behind_ns = accepted.stamp_ns - stamp_ns
            if 0 <= behind_ns <= SET_BACK_NS:
                self._candidate = None
                return BACKWARDS
            if self._run_of(now) < (RUN_AHEAD if behind_ns < 0 else RUN_BACK):
                return AHEAD if behind_ns < 0 else BACKWARDS
        self._accepted, self._candidate = now, None
        return ""

    def _follows(self, accepted: _Moment, now: _Moment) -> bool:
        return accepted.leads_to(now) and (self._repeats or now.stamp_ns > accepted.stamp_ns)

    def _run_of(self, now: _Moment) -> int:
        """How many have gone on from each other by now; one that is repeated is no more than one."""
        candidate, self._candidate = self._candidate, now
        if candidate is None or not candidate.leads_to(now):
            self._run = 1
        elif now.stamp_ns > candidate.stamp_ns:
            self._run += 1
        return self._run
