"""Where measurements come from. One file an input; each has `SOURCE`, a `SourceKind`."""

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from hectorscope.common.paths import absence
from hectorscope.common.registry import members
from hectorscope.inputs import Source, SourceError, SourceOptions


@dataclass(frozen=True, slots=True)
class SourceKind:
    """How one kind of input is recognised and opened. `open` raises SourceError."""

    accepts: Callable[[str], bool]
    open: Callable[[str, SourceOptions], Source]


def open_source(uri: str, options: SourceOptions) -> Source:
    """The source for a path or address; SourceError when no kind accepts it."""
    kinds: list[SourceKind] = members(sys.modules[__name__], "SOURCE")
    for kind in kinds:
        if kind.accepts(uri):
            return kind.open(uri, options)
    if "://" not in uri and (why := absence(Path(uri))):
        raise SourceError(f"{uri} {why}: give a bag, a CARMEN log or ws://HOST:PORT")
    raise SourceError(f"{uri} is neither a recording nor an address: give a bag, a CARMEN log or ws://HOST:PORT")
