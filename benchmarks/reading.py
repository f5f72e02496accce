"""How long reading takes: from the file to measurements, without mapping.

    python -m benchmarks.reading BAG...

For each recording the best of three: seconds of CPU to open and to read, and items a second.
"""

import argparse
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from benchmarks import tables
from benchmarks.cases import TIMED, Recording, present
from hectorscope.inputs import SourceOptions
from hectorscope.sources import open_source

RUNS = 3


class Reading(NamedTuple):
    """Seconds to open and to read, items, and seconds of the recording."""

    opening: float
    reading: float
    items: int
    recorded: float


def measure(recording: Recording) -> Reading:
    """One recording, the best of some runs."""
    return min((_once(recording) for _ in range(RUNS)), key=lambda run: run.opening + run.reading)


def _once(recording: Recording) -> Reading:
    begin = time.process_time()
    source = open_source(str(recording.path), recording.options)
    opened = time.process_time()
    items = sum(1 for _ in source.items())
    first_ns, last_ns = source.span_ns or (0, 0)
    return Reading(opened - begin, time.process_time() - opened, items, (last_ns - first_ns) * 1e-9)


def table(recordings: list[Recording]) -> str:
    """Of all of them, in Markdown."""
    head = ("recording", "items", "open, ms", "read, ms", "items/s", "times real time")
    return tables.table(head, ([recording.name, *_cells(measure(recording))] for recording in recordings))


def _cells(took: Reading) -> Iterator[str]:
    yield str(took.items)
    yield f"{1e3 * took.opening:.0f}"
    yield f"{1e3 * took.reading:.0f}"
    yield f"{took.items / took.reading:.0f}"
    yield f"{took.recorded / (took.opening + took.reading):.0f}"


def main() -> None:
    """Print the table of the given recordings, or of those that the other tables have."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bags", nargs="*", metavar="BAG", help="a recording")
    uris = parser.parse_args().bags
    given = [Recording(Path(uri).name, Path(uri), options=SourceOptions()) for uri in uris]
    print(table(given or present(TIMED)))


if __name__ == "__main__":
    main()
