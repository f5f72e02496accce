"""A run of ten hours at 40 Hz: its memory over time, and what of it the rows and the map take.

    python -m benchmarks.ten_hours [--hours 10] [--beams 181] [--write]

A robot drives through the arena again and again; a process of its own simulates what it measures. The memory is
what the process of the run has to hold (RssAnon and RssShmem of Linux), each minute of the recording; rows lie in
files, of which the system keeps in memory what is read. --write keeps the picture in docs/images/ten-hours.svg.
"""

import argparse
import time
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from multiprocessing import get_context
from multiprocessing.connection import Connection

import numpy as np

from benchmarks.memory import HELD, resident
from benchmarks.svg import Drawing, label, sheet
from benchmarks.tables import table
from hectorscope.inputs import Item
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.run.warmup import load_everything
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.config import SlamConfig
from slam_core.measurements import LaserScan
from tests.conftest import ROOT

HOUR_S, MINUTE_S, RATE = 3600.0, 60.0, 40.0
AT_ONCE = 5000  # items that pass from one process to the other
MEBIBYTE = 2**20
WIDTH, HEIGHT, LEFT, BELOW = 720.0, 300.0, 60.0, 24.0
COLOURS = {"memory of the process": "#18202c", "of that, rows": "#d1495b", "of that, the map": "#00798c"}
PICTURE = ROOT / "docs" / "images" / "ten-hours.svg"


@dataclass(frozen=True, slots=True)
class Look:
    """At the run at one moment. memory, rows, map: MiB."""

    hours: float
    scans: int
    memory: float
    rows: float
    map: float

    @property
    def lines(self) -> tuple[float, ...]:
        """In the order of COLOURS."""
        return self.memory, self.rows, self.map


def simulated(hours: float, beams: int, end: Connection) -> None:
    """Send the drive, in parts; an empty one at the end."""
    scene = Simulation("arena", SceneOptions(duration=HOUR_S * hours, beams=beams, scan_rate=RATE))
    items = scene.items()
    while some := list(islice(items, AT_ONCE)):
        end.send(some)
    end.send([])


def received(hours: float, beams: int) -> Iterator[Item]:
    """The drive, from the other process."""
    context = get_context("spawn")
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(target=simulated, args=(hours, beams, theirs), daemon=True)
    process.start()
    while some := ours.recv():
        yield from some
    process.join()


def look(pipeline: Pipeline, hours: float) -> Look:
    """Now."""
    rows = (pipeline.trajectory, pipeline.series, pipeline.truth, pipeline.navigation)
    size = sum(each.nbytes for each in rows) / MEBIBYTE
    return Look(hours, pipeline.scans, resident(HELD), size, pipeline.slam.map.nbytes / MEBIBYTE)


def looks(hours: float, beams: int) -> Iterator[Look]:
    """One each minute of the recording."""
    pipeline, minutes = Pipeline(Settings(SlamConfig())), 0
    for item in received(hours, beams):
        for measurement in pipeline.admit(item):
            pipeline.step(measurement)
        if isinstance(item, LaserScan) and pipeline.scans and pipeline.trajectory[-1, 0] >= minutes * MINUTE_S:
            yield look(pipeline, minutes * MINUTE_S / HOUR_S)
            minutes += 1
    yield look(pipeline, float(pipeline.trajectory[-1, 0]) / HOUR_S)


def drawn(found: list[Look]) -> str:
    """Lines over the hours, as an SVG."""
    hours = np.array([each.hours for each in found])
    most = max(each.memory for each in found)
    across, up = (WIDTH - LEFT) / hours[-1], (HEIGHT - BELOW) / most
    content = f'<path d="M{LEFT} 0V{HEIGHT - BELOW}H{WIDTH}" fill="none" stroke="#8a93a3"/>'
    for at in np.linspace(0.0, hours[-1], 6):
        content += label(LEFT + across * float(at), HEIGHT - 4, f"{at:.3g} h")
    for at in np.linspace(0.0, most, 5)[1:]:
        content += label(LEFT / 2 - 4, HEIGHT - BELOW - up * float(at) + 12, f"{at:.0f} MiB")
    for k, (name, colour) in enumerate(COLOURS.items()):
        points = " ".join(f"{LEFT + across * x.hours:.1f},{HEIGHT - BELOW - up * x.lines[k]:.1f}" for x in found)
        content += f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="2"/>'
        content += label(LEFT + 120, 20 + 22 * k, name, colour)
    return sheet([Drawing(WIDTH, HEIGHT, content, "a run at 40 Hz: memory over the time of the recording")])


def main() -> None:
    """Print a line each hour, then the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--hours", type=float, default=10.0)
    parser.add_argument("--beams", type=int, default=181)
    parser.add_argument("--write", action="store_true", help="write docs/images/ten-hours.svg")
    given = parser.parse_args()
    load_everything()
    begun, found, rows = time.perf_counter(), [], []
    for each in looks(given.hours, given.beams):
        found.append(each)
        if len(found) % 60 == 1:
            cells = f"{each.hours:.3g}", f"{each.scans}", *(f"{value:.0f} MiB" for value in each.lines)
            print(" | ".join(cells), f"({time.perf_counter() - begun:.0f} s)", flush=True)
            rows.append(cells)
    if given.write:
        PICTURE.write_text(drawn(found), encoding="utf-8")
    print(table(("hour", "scans", *COLOURS), rows))


if __name__ == "__main__":
    main()
