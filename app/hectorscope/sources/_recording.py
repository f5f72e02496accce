"""What every container of recorded messages looks like once it is open, whatever wrote it."""

import heapq
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import NamedTuple, Protocol

from hectorscope.ros.decode import DefinitionFormat, Generation


class Channel(NamedTuple):
    """One topic in one type, as the container describes it; definition is empty where it carries none."""

    topic: str
    msgtype: str
    generation: Generation
    definition: str = ""
    form: DefinitionFormat = "msg"


@dataclass(slots=True, eq=False)
class Raw:
    """One serialised message and when it was recorded."""

    channel: Channel
    log_ns: int
    data: bytes


@dataclass(slots=True)
class Passed:
    """What was read so far: the messages of each channel, the last one's time, and how many of that time."""

    read: Counter[Channel] = field(default_factory=Counter)
    time_ns: int = 0
    same: int = 0

    def note(self, raw: Raw) -> None:
        """One more."""
        self.read[raw.channel] += 1
        self.same = self.same + 1 if raw.log_ns == self.time_ns else 1
        self.time_ns = raw.log_ns


NOTHING = Passed()


class Read(Protocol):
    """Gives the messages of some channels by time."""

    def __call__(self, channels: Collection[Channel], passed: Passed = NOTHING) -> Iterator[Raw]:
        """Those behind what was read of the same channels; every call starts anew."""


@dataclass(frozen=True, slots=True)
class Recording:
    """An open container.

    container: what it is, for people. span_ns: times of the first and the last message.
    damage: why it is known not to be whole; empty if it is. close: let go of the files.
    """

    path: Path
    container: str
    messages: Counter[Channel]
    span_ns: tuple[int, int]
    read: Read
    damage: str = ""
    close: Callable[[], None] = lambda: None


MOST_KEPT = 2**28  # bytes of messages that wait to be sorted
OVERHEAD = 250  # bytes that a message takes besides its data


def by_scanning(path: Path, container: str, scan: Callable[[], Iterator[Raw]], damage: str) -> Recording:
    """A recording without a usable index: read through once for its contents, and sorted at every reading.

    What is kept to be sorted is as long as messages come late in the file, and not the whole of it.
    """
    messages: Counter[Channel] = Counter()
    first_ns, last_ns, late_ns = 2**63, 0, 0
    for raw in scan():
        messages[raw.channel] += 1
        first_ns, last_ns = min(first_ns, raw.log_ns), max(last_ns, raw.log_ns)
        late_ns = max(late_ns, last_ns - raw.log_ns)

    def read(channels: Collection[Channel], passed: Passed = NOTHING) -> Iterator[Raw]:
        wanted = frozenset(channels)
        raws = in_order((raw for raw in scan() if raw.channel in wanted), late_ns)
        yield from islice(raws, passed.read.total(), None)

    return Recording(path, container, messages, (first_ns, last_ns), read, damage)


def in_order(raws: Iterable[Raw], late_ns: int) -> Iterator[Raw]:
    """Messages by time, those of one time as they come; none comes later than `late_ns` after a newer one.

    One that comes behind more than MOST_KEPT bytes stays late.
    """
    waiting: list[tuple[int, int, Raw]] = []
    newest_ns, kept = 0, 0
    for number, raw in enumerate(raws):
        heapq.heappush(waiting, (raw.log_ns, number, raw))
        newest_ns = max(newest_ns, raw.log_ns)
        kept += _size(raw)
        while waiting and (waiting[0][0] <= newest_ns - late_ns or kept > MOST_KEPT):
            oldest = heapq.heappop(waiting)[-1]
            kept -= _size(oldest)
            yield oldest
    while waiting:
        yield heapq.heappop(waiting)[-1]


def _size(raw: Raw) -> int:
    return len(raw.data) + OVERHEAD


def joined(path: Path, parts: Iterable[Recording], damage: str) -> Recording:
    """Several files of one recording as one."""
    pieces = list(parts)
    messages: Counter[Channel] = Counter()
    for piece in pieces:
        messages.update(piece.messages)

    def read(channels: Collection[Channel], passed: Passed = NOTHING) -> Iterator[Raw]:
        raws = heapq.merge(*(piece.read(channels) for piece in pieces), key=_log_time)
        return islice(raws, passed.read.total(), None)

    full = [piece.span_ns for piece in pieces if piece.messages]
    span_ns = (min((s[0] for s in full), default=0), max((s[1] for s in full), default=0))
    damages = [damage, *(piece.damage for piece in pieces)]

    def close() -> None:
        for piece in pieces:
            piece.close()

    damage = "; ".join(filter(None, damages))
    return Recording(path, pieces[0].container, messages, span_ns, read, damage, close)


def _log_time(raw: Raw) -> int:
    return raw.log_ns
