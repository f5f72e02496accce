"""Stamps by clocks that are far from that of the scans, told by when messages were recorded or received."""

from dataclasses import dataclass, field

WINDOW_NS = 2_000_000_000  # in which the delays of messages are compared
# The delays of two clocks differ by more than this; than so many periods of a sensor, as some send a measurement
# with the next; and than so many times what each varies: a long way does not take the same time again and again.
APART_NS, PERIODS, SPREADS = 500_000_000, 2, 20
TOGETHER_NS = 250_000_000  # they are together again
SET_NS = 5_000_000_000  # no message is so long on its way: its clock is set
SLIP_NS = 1_000_000  # in a window: two quartz clocks drift apart by less, and what grows faster is the way
SPAN_NS = 800_000_000  # of a window, at least, that messages tell about
PACE = 2.0  # by which time in stamps may pass too fast or too slowly
FAST = 5  # one of so many messages is about as fast as the way permits, as many are slow; stamps may be wrong
MOST_KEPT = 1000  # delays in a window
CALM_NS = 20_000_000_000  # before messages wait once more


@dataclass(slots=True, eq=False)
class _Clock:
    """Of a stream of messages. level_ns: their usual delay. shift_ns: what is added to their stamps.

    least_ns: by which clocks are apart at least. apart_ns: by which their levels are, if they are. is_known:
    whether the last window told the level; until one ends, it is the first delay.
    """

    level_ns: int
    least_ns: int
    apart_ns: int = 0
    shift_ns: int = 0
    is_known: bool = False
    delays: list[int] = field(default_factory=list)
    first: tuple[int, int] = (0, 0)
    last: tuple[int, int] = (0, 0)

    def add(self, stamp_ns: int, delay_ns: int, receive_ns: int) -> None:
        """A message of this window."""
        self.last = stamp_ns, receive_ns
        if not self.delays:
            self.first = self.last
        if len(self.delays) < MOST_KEPT:
            self.delays.append(delay_ns)

    def judge(self) -> bool:
        """End the window. Whether the level was found by it: not where stamps do not count time."""
        delays, self.delays = sorted(self.delays), []
        stamped_ns, received_ns = (last - first for first, last in zip(self.first, self.last, strict=True))
        if not delays or received_ns < SPAN_NS:
            return False
        level_ns, is_known = delays[len(delays) // FAST], received_ns < PACE * stamped_ns < PACE**2 * received_ns
        spread_ns, period_ns = delays[-1 - len(delays) // FAST] - level_ns, received_ns // max(1, len(delays) - 1)
        self.apart_ns = max(self.least_ns, PERIODS * period_ns, SPREADS * spread_ns)
        if is_known and self.is_known and not self.is_apart(level_ns):
            level_ns = min(level_ns, self.level_ns + SLIP_NS)
        self.level_ns, self.is_known = level_ns, is_known
        return is_known

    def is_apart(self, level_ns: int) -> bool:
        """Whether a level is that of another clock."""
        return abs(level_ns - self.level_ns) > self.apart_ns


class Clocks:
    """Compares the clocks of streams of messages with that of one of them, the scans.

    A delay lasts from the end of a measurement to the receipt of its message, so it contains the difference of two
    clocks. One that differs from that of the scans by much, and always by the same, shows that the clocks are
    apart. While that is found out, messages wait. lead: the stream of the scans, None while there is none.
    """

    def __init__(self, lead: str | None) -> None:
        self.lead = lead
        self._clocks: dict[str, _Clock] = {}
        self._begin_ns: int | None = None
        self._calm_ns = 0
        self._is_unsure, self._is_silent = False, True

    def note(self, name: str, stamp_ns: int, lasts_ns: int, receive_ns: int, least_ns: int = APART_NS) -> None:
        """A message, in order of receipt. lasts_ns: of the measurement, from its stamp on.

        least_ns: by which its clock is apart at least, if it is.
        """
        if self._begin_ns is None:
            self._begin_ns = receive_ns
        if not 0 <= receive_ns - self._begin_ns < WINDOW_NS:
            self.settle()
            self._begin_ns = receive_ns
        delay_ns = receive_ns - stamp_ns - lasts_ns
        clock = self._clocks.get(name)
        if clock is None:
            clock = _Clock(delay_ns, least_ns)
            is_apart = self._is_beside(clock)
            self._clocks[name] = clock
        else:
            # it was set; of one that counts another time nothing is known
            is_apart = clock.is_known and abs(delay_ns - clock.level_ns) > SET_NS
        if is_apart and receive_ns >= self._calm_ns:
            for each in self._clocks.values():
                each.delays.clear()
            self._begin_ns, self._calm_ns, self._is_unsure = receive_ns, receive_ns + CALM_NS, True
        self._is_silent &= name != self.lead
        clock.add(stamp_ns, delay_ns, receive_ns)
        if (self._is_unsure or self._is_silent) and abs(stamp_ns - clock.first[0]) > PACE * WINDOW_NS:
            self.settle()  # the receipt does not count time, or not that of the stamps
            self._begin_ns = receive_ns

    def settle(self) -> None:
        """End the window: nothing waits any more."""
        self._is_unsure = self._is_silent = False
        judged = {name: clock for name, clock in self._clocks.items() if clock.judge()}
        lead = judged.pop(self.lead or "", None)
        if lead is None:
            return
        for clock in judged.values():
            apart_ns = clock.level_ns - lead.level_ns
            is_apart = clock.is_apart(lead.level_ns) and lead.is_apart(clock.level_ns)
            still = clock.shift_ns != 0 and abs(apart_ns) > TOGETHER_NS
            clock.shift_ns = apart_ns if is_apart or still else 0

    @property
    def waits(self) -> bool:
        """Whether messages have to wait until the clocks are known."""
        return self.lead is not None and (self._is_unsure or self._is_silent)

    def shift_ns(self, name: str) -> int:
        """What is added to the stamps of a stream, so that they are by the clock of the scans."""
        clock = self._clocks.get(name)
        return clock.shift_ns if clock else 0

    @property
    def shifts_ns(self) -> dict[str, int]:
        """Of the streams whose clocks are apart from that of the scans."""
        return {name: clock.shift_ns for name, clock in self._clocks.items() if clock.shift_ns}

    def _is_beside(self, new: _Clock) -> bool:
        """Whether a clock that appears is another one than those that are there."""
        others = self._clocks.values()
        return any(abs(new.level_ns - each.level_ns) > max(new.least_ns, each.least_ns) for each in others)
