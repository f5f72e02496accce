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

    suffixes: of its files, by which they are found in a folder.
    """

    accepts: Callable[[str], bool]
    open: Callable[[str, SourceOptions], Source]
    suffixes: tuple[str, ...] = ()


def open_source(uri: str, options: SourceOptions) -> Source:
    """The source for a path or address; SourceError when no kind accepts it."""
    kinds: list[SourceKind] = members(sys.modules[__name__], "SOURCE")
    for kind in kinds:
        if kind.accepts(uri):
            return kind.open(uri, options)
    if "://" not in uri and (why := absence(Path(uri))):
        raise SourceError(f"{uri} {why}: give a bag, a CARMEN log or ws://HOST:PORT")
    raise SourceError(f"{uri} is neither a recording nor an address: give a bag, a CARMEN log or ws://HOST:PORT")


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
