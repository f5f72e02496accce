"""A recording of an hour at 40 Hz: the time to open it and to seek in it, the memory, and how fluid the page is.

    python -m benchmarks.hour [BAG] [--seeks 100]

Without a recording, the arena of the demo is simulated for an hour into a temporary folder, which takes some
minutes and 1 GB. A recording is open once its first scan is shown. The pass then runs to its end, and behind it
random times are sought, from the command to the published snapshot. In a real Chromium, whose own drawing in
software is counted, the curves of the whole hour are shown, and random times are sought; a gap is the time between
two frames meanwhile. Memory is the most that the process of the server ever had.
"""

import argparse
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from playwright.sync_api import sync_playwright

from benchmarks.seek import LOOK_S, READY, drawn, published, rest, until_whole
from benchmarks.tables import table
from hectorscope.checks.sensor_check import CheckedSource
from hectorscope.inputs import SourceOptions
from hectorscope.run.warmup import load_everything
from hectorscope.session.commands import Pause
from hectorscope.session.engine import Engine
from hectorscope.sources import open_source
from hectorscope.web.server import PageServer
from tests.conftest import FLAGS, ROOT, chromium_path

HOUR_S = 3600.0
PATIENCE_MS = 600_000
SHOWN = "window.hectorscope.plotted().tables.series?.known === {rows}"
WHOLE = "window.hectorscope.own.set('window', 1e9)"
GAPS = """() => {
  const gaps = (window.gaps = []);
  let before = performance.now();
  const frame = (now) => {
    gaps.push(now - before);
    before = now;
    requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
}"""


@contextmanager
def recording(given: Path | None) -> Iterator[Path]:
    """The given one, or a simulated hour that is removed in the end."""
    with tempfile.TemporaryDirectory() as folder:
        if given is None:
            # In a process of its own: its memory is not that of a server.
            command = [sys.executable, "-m", "hectorscope.cli.main", "simulate", "--scenario", "arena"]
            command += ["--duration", str(HOUR_S), "--out", str(Path(folder) / "hour.bag")]
            subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
        yield given or Path(folder) / "hour.bag"


def measured(path: Path, seeks: int) -> Iterator[tuple[str, str]]:
    """Figures for people, as they come."""
    yield "file", f"{path.stat().st_size / 2**20:.0f} MiB"
    begun = time.perf_counter()
    engine = Engine(CheckedSource(partial(open_source, str(path)), SourceOptions()))
    engine.start()
    while not ((now := engine.mailbox.latest) and now.scans):
        time.sleep(LOOK_S)
    yield "opened after", f"{time.perf_counter() - begun:.2f} s"
    rest(engine, Pause())
    scans = len(until_whole(engine).ahead.series)
    yield "one pass", f"{time.perf_counter() - begun:.0f} s, {scans} scans"
    yield "seeks behind the pass", _times(published(engine, seeks))
    yield from shown(engine, scans, seeks)
    yield "memory", f"{resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**10:.0f} MiB"
    engine.stop()


def shown(engine: Engine, scans: int, seeks: int) -> Iterator[tuple[str, str]]:
    """The same with a page that shows all of it."""
    server = PageServer(engine, port=0)
    server.start()
    with sync_playwright() as playwright:
        page = playwright.chromium.launch(executable_path=chromium_path(), args=FLAGS).new_page()
        begun = time.perf_counter()
        page.goto(f"{server.url}?fixedDpr=0.3")
        page.wait_for_function(READY, timeout=PATIENCE_MS)
        page.wait_for_function(SHOWN.format(rows=scans), timeout=PATIENCE_MS)
        yield "all rows in the page after", f"{time.perf_counter() - begun:.1f} s"
        page.evaluate(WHOLE)
        page.evaluate(GAPS)
        yield "seeks, until the map is drawn", _times(drawn(engine, page, seeks))
        yield "gaps between frames meanwhile", _times(page.evaluate("window.gaps"))
    server.stop()


def _times(taken: list[float]) -> str:
    """Milliseconds for people."""
    tenth = sorted(taken)[-max(1, len(taken) // 10)]
    return f"median {statistics.median(taken):.0f} ms, slowest tenth {tenth:.0f} ms, longest {max(taken):.0f} ms"


def main() -> None:
    """Print the figures as they come, and the table of them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bag", nargs="?", type=Path)
    parser.add_argument("--seeks", type=int, default=100)
    options = parser.parse_args()
    load_everything()
    figures = []
    with recording(options.bag) as path:
        for name, value in measured(path, options.seeks):
            print(f"{name}: {value}", flush=True)
            figures.append((name, value))
    print(table(("an hour at 40 Hz", ""), figures))


if __name__ == "__main__":
    main()
