"""What a person at a terminal sees of long work: a bar while it lasts, figures at the end."""

import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from hectorscope.common.terminal import printable
from hectorscope.inputs import Source

if TYPE_CHECKING:
    from hectorscope.simulation import SimulateOptions
    from hectorscope.sweep.spec import RunSpec
    from hectorscope.sweep.table import Table as SweepTable

REFRESH_S = 0.1
BEST = 5  # settings of a sweep that are printed


@contextmanager
def _bar(title: str) -> Iterator[Callable[[float], None]]:
    """A bar on stderr; yields what takes the share that is done, 0 to 1, as often as it likes."""
    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TaskProgressColumn(),
        TimeRemainingColumn(),
    )
    drawn = 0.0
    with Progress(*columns, console=Console(stderr=True), auto_refresh=False) as bar:
        task = bar.add_task(printable(title), total=1.0)

        def show(share: float) -> None:
            nonlocal drawn
            if share >= 1.0 or time.monotonic() - drawn >= REFRESH_S:
                drawn = time.monotonic()
                bar.update(task, completed=share, refresh=True)

        yield show
        show(1.0)


@contextmanager
def show_progress(source: Source) -> Iterator[Callable[[int], None]]:
    """A bar over the time of a recording; yields what takes the time that is reached."""
    first_ns, last_ns = source.span_ns or (0, 1)
    with _bar(source.name) as show:
        yield lambda time_ns: show((time_ns - first_ns) / max(1, last_ns - first_ns))


def show_simulation(options: "SimulateOptions") -> None:
    """Make the recording with a progress bar, and print its path."""
    from hectorscope.simulation import simulate  # noqa: PLC0415  nobody else waits for the simulator

    with _bar(options.scenario) as show:
        simulate(options, show)
    print(f"wrote {options.out}")


@contextmanager
def show_sweep(runs: int) -> Iterator[Callable[[float], None]]:
    """A bar over the runs of a sweep; yields what takes the share that is done."""
    with _bar(f"{runs} runs") as show:
        yield show


def sweep_summary(table: "SweepTable", specs: "Sequence[RunSpec]", target: str | None, folder: Path) -> None:
    """How the runs of a sweep ended, and its best settings, as a table."""
    from hectorscope.sweep.ranking import places, target_of  # noqa: PLC0415  for a sweep alone
    from hectorscope.sweep.table import text  # noqa: PLC0415

    rows = {spec.key: table.rows[spec.key] for spec in specs}
    figure = target or target_of(rows.values())
    best = Table(title=f"Best settings by {figure}, over all recordings")
    for name in (*table.names, "median", "bad runs"):
        best.add_column(name)
    for place in places(specs, rows, figure)[:BEST]:
        values = (text(place.spec.value(name)) or "default" for name in table.names)
        cells = (*values, text(place.median), str(place.bad))
        best.add_row(*(Text(printable(cell)) for cell in cells))
    ended = Counter(row["status"] for row in rows.values())
    Console().print(best)
    print(f"{len(rows)} runs: " + ", ".join(f"{count} {status}" for status, count in ended.most_common()))
    print(f"The table is {folder / 'runs.csv'}; look at it by: hectorscope sweep --show {folder}")


def summary(name: str, figures: dict[str, Any], folder: Path) -> None:
    """The figures of a run, as a table."""
    table = Table(title=Text(printable(name), "table.title"), show_header=False)
    for row in (*_rows(figures), ("results", str(folder))):
        table.add_row(*(Text(printable(cell)) for cell in row))  # as it is: names may look like markup
    Console().print(table)


def _rows(figures: dict[str, Any]) -> Iterator[tuple[str, str]]:
    scans = figures["scans"]
    yield "scans", f"{scans['used']} used of {scans['read']}"
    yield "tracking", ", ".join(f"{count} {state}" for state, count in figures["tracking"].items())
    for reason, count in {**scans["skipped"], **figures["messages"]["skipped"]}.items():
        yield "  skipped", f"{count} x {reason}"
    for note in figures["notes"]:
        yield "  note", note
    factor = figures["realtime_factor"]
    yield "time", f"{figures['recording_s']:.1f} s in {figures['wall_s']:.1f} s: {factor:.1f} x real time"
    yield "a scan takes", ", ".join(f"{part} {us:.0f}" for part, us in figures["median_us"].items()) + " us"
    yield "map", f"{figures['map_updates']} updates, {figures['occupied_cells']} occupied cells"
    if figures["truth"] is not None:
        yield from _truth_rows(figures["truth"])
    if "relations" in figures:
        yield "relations", _relations(figures["relations"])


def _truth_rows(truth: dict[str, float]) -> Iterator[tuple[str, str]]:
    yield "trajectory error", f"{truth['aligned_rmse_m']:.4f} m aligned, {truth['raw_rmse_m']:.4f} m raw"
    if "roll_rms_deg" in truth:
        yield "attitude error", f"roll {truth['roll_rms_deg']:.3f} deg, pitch {truth['pitch_rms_deg']:.3f} deg"
    if "height_rms_m" in truth:
        yield "height error", f"{truth['height_rms_m']:.3f} m"


def _relations(found: dict[str, float]) -> str:
    """Mean and standard deviation, as the tables of the literature have them."""
    if not found["used"]:
        return f"none of {found['given']} lies within the times of the scans"
    metres = f"{found['translation_mean_m']:.4f} ± {found['translation_std_m']:.4f} m"
    degrees = f"{found['rotation_mean_deg']:.3f} ± {found['rotation_std_deg']:.3f} deg"
    return f"{metres}, {degrees}, over {found['used']} of {found['given']}"
