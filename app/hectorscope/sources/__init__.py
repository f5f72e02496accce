"""Where measurements come from. One file an input; each has `SOURCE`, a `SourceKind`."""

import os
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from hectorscope.common.paths import absence
from hectorscope.common.registry import members
from hectorscope.inputs import Source, SourceError, SourceOptions


@dataclass(frozen=True, slots=True)
class SourceKind:
    """How one kind of input is recognised and opened. `open` raises SourceError.

    suffixes: of its files, by which they are found in a folder. addresses: the forms of those of a stream.
    """

    accepts: Callable[[str], bool]
    open: Callable[[str, SourceOptions], Source]
    suffixes: tuple[str, ...] = ()
    addresses: tuple[str, ...] = ()


def stream(open_: Callable[[str, SourceOptions], Source], *addresses: str) -> SourceKind:
    """A kind that is recognised by the schemes of its addresses, such as ws://HOST:PORT."""
    schemes = {scheme(address) for address in addresses}
    return SourceKind(lambda uri: scheme(uri) in schemes, open_, addresses=addresses)


def scheme(uri: str) -> str:
    """What stands before "://"; "-" for the standard input; "" for a path."""
    return uri if uri == "-" else uri.partition("://")[0] if "://" in uri else ""


def addresses() -> tuple[str, ...]:
    """The forms of the addresses of streams."""
    kinds: list[SourceKind] = members(sys.modules[__name__], "SOURCE")
    return tuple(address for kind in kinds for address in kind.addresses)


def open_source(uri: str, options: SourceOptions) -> Source:
    """The source for a path or address; SourceError when no kind accepts it."""
    kinds: list[SourceKind] = members(sys.modules[__name__], "SOURCE")
    for kind in sorted(kinds, key=lambda kind: not kind.addresses):  # a name may be that of a file, too
        if kind.accepts(uri):
            return kind.open(uri, options)
    if "://" in uri:
        raise SourceError(f"{scheme(uri)}:// is no kind of address that is known: give {', '.join(addresses())}")
    why = absence(Path(uri)) or "is neither a recording nor an address"
    raise SourceError(f"{uri} {why}: give a bag, a CARMEN log or ws://HOST:PORT")


DEEPEST = 4  # folders in folders that are looked through


def suffix_of(name: str) -> str:
    """Of the suffixes of recordings the one that a name ends in; "" for none of them."""
    kinds: list[SourceKind] = members(sys.modules[__name__], "SOURCE")
    known = (suffix for kind in kinds for suffix in kind.suffixes)
    return max((suffix for suffix in known if name.endswith(suffix)), key=len, default="")


def recordings_in(folder: Path) -> Iterator[Path]:
    """Files and rosbag2 folders below a folder, by name. Nothing that a link leads out of it to."""
    top = folder.resolve()
    for place, folders, files in os.walk(top):
        here = Path(place)
        folders.sort()
        if "metadata.yaml" in files and here != top:
            folders.clear()
            if all(is_inside(here / file, top) for file in files):
                yield here
            continue
        if len(here.relative_to(top).parts) >= DEEPEST:
            folders.clear()
        yield from (here / name for name in sorted(files) if suffix_of(name) and is_inside(here / name, top))


def is_inside(path: Path, folder: Path) -> bool:
    """Whether a file or folder is there and lies below `folder`, also once all links were followed."""
    try:
        real = path.resolve(strict=True)
    except (OSError, RuntimeError):  # gone, locked, or a link to itself
        return False
    return real.is_relative_to(folder) and (real.is_file() or real.is_dir())
