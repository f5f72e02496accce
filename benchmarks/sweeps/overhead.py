"""What a sweep costs beyond its runs: 200 runs of the demos on two processes, beside the same runs in plain loops.

    python -m benchmarks.sweeps.overhead [--runs 200] [--write]

The plain loops check the sensors, read, run and score as `hectorscope run` does, and keep nothing. They take turns
with the sweep, in blocks; the time of the processors is compared, and that of the wall. --write keeps the outcome
in docs/sweeps.md.
"""

import argparse
import os
import tempfile
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from statistics import median

from benchmarks.cases import DEMOS
from benchmarks.sweeps.cases import base_of
from benchmarks.sweeps.marks import fill
from benchmarks.tables import table
from hectorscope.checks.sensor_check import CheckedSource
from hectorscope.run.headless import run_headless
from hectorscope.run.metrics import metrics
from hectorscope.run.warmup import load_everything
from hectorscope.sources import open_source
from hectorscope.sweep.executors import executor
from hectorscope.sweep.limits import Limits
from hectorscope.sweep.plan import with_setting
from hectorscope.sweep.spec import RunSpec
from hectorscope.sweep.sweep import sweep
from hectorscope.sweep.table import Row, Table
from tests.conftest import ROOT

RUNS, BLOCK, PROCESSES = 200, 25, 2
EARLY = 20  # runs at either end whose memory is compared
TICKS = os.sysconf("SC_CLK_TCK")


@dataclass(frozen=True, slots=True)
class Spent:
    """Seconds of the wall, and of the processors in all processes."""

    wall: float
    cpu: float

    def __add__(self, other: "Spent") -> "Spent":
        return Spent(self.wall + other.wall, self.cpu + other.cpu)


def specs_of(count: int) -> list[RunSpec]:
    """The demos in turn, with so many values of sigma."""
    bases = [base_of(demo) for demo in DEMOS]
    values = [round(0.1 + 0.2 * k / count, 5) for k in range(count)]
    return [with_setting(bases[k % len(bases)], {"matcher.sigma": value}) for k, value in enumerate(values)]


def plain(spec: RunSpec) -> float:
    """A run and its figures."""
    source = CheckedSource(partial(open_source, spec.path), spec.source_options())
    pipeline, effort = run_headless(source, spec.run_settings())
    metrics(pipeline, source.report, effort)
    return effort.wall_s


def looped(pool: Executor, specs: Sequence[RunSpec]) -> None:
    """Each of them in a plain loop."""
    list(pool.map(plain, specs))


def spent(work: Callable[[], object]) -> Spent:
    """What some work takes here and in the processes that are started."""
    wall, cpu = time.perf_counter(), processors()
    work()
    return Spent(time.perf_counter() - wall, processors() - cpu)


def processors() -> float:
    """Seconds of the processors in this process and in those that it has started and that live."""
    lists = Path("/proc/self/task").glob("*/children")
    children = {pid for each in lists for pid in each.read_text().split()}
    stats = (Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split() for pid in children)
    return time.process_time() + sum(int(stat[11]) + int(stat[12]) for stat in stats) / TICKS


def measure(specs: Sequence[RunSpec], folder: Path) -> tuple[list[Spent], list[Spent], list[Row]]:
    """Of each block the plain loops, and the sweep, whose first one starts the processes; and the rows."""
    rows, loops, sweeps = Table(folder, ["matcher.sigma"]), list[Spent](), list[Spent]()
    with ProcessPoolExecutor(PROCESSES, initializer=load_everything) as pool, executor(PROCESSES) as own:
        list(pool.map(plain, specs[: 2 * PROCESSES]))  # its processes are ready
        for begin in range(0, len(specs), BLOCK):
            block = specs[begin : begin + BLOCK]
            loops.append(spent(partial(looped, pool, block)))
            sweeps.append(spent(partial(sweep, block, rows, own, Limits())))
            print(f"{begin + len(block)} runs: {loops[-1]} {sweeps[-1]}", flush=True)
    return loops, sweeps, list(rows.rows.values())


def described(loops: list[Spent], sweeps: list[Spent], rows: list[Row]) -> str:
    """As Markdown."""
    whole = [sum(each, Spent(0.0, 0.0)) for each in (loops, sweeps)]
    ratios = {
        what: median(getattr(b, what) / getattr(a, what) for a, b in zip(loops[1:], sweeps[1:], strict=True))
        for what in ("cpu", "wall")
    }
    memory = [float(row["memory_mb"]) for row in rows]
    early, late = median(memory[:EARLY]), median(memory[-EARLY:])
    head = (f"{len(rows)} runs on {PROCESSES} processes", "processors", "wall")
    lines = [
        ("plain loops, kernels loaded before", f"{whole[0].cpu:.1f} s", f"{whole[0].wall:.1f} s"),
        ("the sweep, with the start of its processes", f"{whole[1].cpu:.1f} s", f"{whole[1].wall:.1f} s"),
        ("more", f"{whole[1].cpu / whole[0].cpu - 1:+.1%}", f"{whole[1].wall / whole[0].wall - 1:+.1%}"),
        (
            f"more, median of the blocks of {BLOCK} runs after the first",
            f"{ratios['cpu'] - 1:+.1%}",
            f"{ratios['wall'] - 1:+.1%}",
        ),
    ]
    workers = len({row["worker"] for row in rows})
    return table(head, lines) + (
        f"\n{workers} processes did all runs, so kernels were loaded {workers} times. Memory of a process:"
        f" {early:.0f} MiB in its first rows, {late:.0f} MiB in its last (medians of {EARLY}).\n"
    )


def main() -> None:
    """Measure and tell."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=RUNS)
    parser.add_argument("--write", action="store_true")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as made:
        text = described(*measure(specs_of(args.runs), Path(made)))
    print(text)
    if args.write:
        fill(ROOT / "docs" / "sweeps.md", "overhead", text)


if __name__ == "__main__":
    main()
