"""The root of every error that a person is meant to read, and what a mistyped name was meant to be."""

from collections.abc import Iterable
from difflib import SequenceMatcher

CLOSE = 0.65  # ratio of difflib from which a name is worth a proposal


class SlamError(Exception):
    """A mistake with a remedy: the message gives the fact, the value and what to do."""


def nearest(name: str, offered: Iterable[str], separator: str = "/") -> str:
    """The name among `offered` that `name` most likely means, or "" if none is close.

    A name whose last part, behind the last `separator`, is right counts as close.
    """

    def likeness(other: str) -> tuple[float, float]:
        whole = SequenceMatcher(None, name.lower(), other.lower()).ratio()
        end, other_end = (text.lower().rpartition(separator)[2] for text in (name, other))
        return max(whole, SequenceMatcher(None, end, other_end).ratio()), whole

    best = max(offered, key=likeness, default="")
    return best if best and likeness(best)[0] >= CLOSE else ""
