"""Where results are published while the run goes on. One file a protocol; each has `BUS`, a `BusKind`."""

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

from hectorscope.common.registry import members
from hectorscope.results.topics import Message
from slam_core.errors import SlamError


class PublishError(SlamError):
    """Results cannot be published there: the message says why, and the remedy."""


class Bus(Protocol):
    """An open way out. Nothing of it waits for whoever listens: a slow one loses messages."""

    def wants(self, topic: str) -> bool:
        """Whether anybody has subscribed to it."""

    def publish(self, message: Message) -> None:
        """Send it to whoever listens."""

    def close(self) -> None:
        """Hang up."""


@dataclass(frozen=True, slots=True)
class BusKind:
    """form: of the addresses, by whose scheme they are told apart. open: PublishError if that cannot be."""

    form: str
    open: Callable[[str], Bus]


def open_bus(uri: str) -> Bus:
    """The way out at an address; PublishError when there is none."""
    kinds: list[BusKind] = members(sys.modules[__name__], "BUS")
    for kind in kinds:
        if uri.partition("://")[0] == kind.form.partition("://")[0] and "://" in uri:
            return kind.open(uri)
    raise PublishError(f"results cannot be published at {uri}: give {' or '.join(forms())}")


def forms() -> Sequence[str]:
    """The forms of the addresses."""
    kinds: list[BusKind] = members(sys.modules[__name__], "BUS")
    return [kind.form for kind in kinds]
