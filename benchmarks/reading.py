"""How long reading takes: from the file to measurements, without mapping.

    python benchmarks/reading.py BAG...

Prints, for each recording, the best of three: CPU seconds to open and to read, messages a second, and how many
times faster than real time that is.
"""

import sys
import time

from app.sources import SourceOptions, open_source


def measure(uri: str) -> tuple[float, float, int, float]:
    """(seconds to open, seconds to read, items, seconds of the recording)."""
    begin = time.process_time()
    source = open_source(uri, SourceOptions())
    opened = time.process_time()
    items = sum(1 for _ in source.items())
    done = time.process_time()
    first_ns, last_ns = source.span_ns or (0, 0)
    return opened - begin, done - opened, items, (last_ns - first_ns) * 1e-9


def main() -> None:
    for uri in sys.argv[1:]:
        runs = [measure(uri) for _ in range(3)]
        opening, reading = min(run[0] for run in runs), min(run[1] for run in runs)
        _, _, items, seconds = runs[0]
        factor = seconds / (opening + reading)
        print(f"{uri}: open {opening:.3f} s, read {reading:.3f} s, {items / reading:.0f} items/s, {factor:.0f}x")


if __name__ == "__main__":
    main()
