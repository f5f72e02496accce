"""What tests of sweeps share: recordings, specs on them, the table without its times, processes and waiting."""

import csv
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from hectorscope.simulation import SimulateOptions, simulate
from hectorscope.sweep.spec import RunSpec
from hectorscope.sweep.table import CSV, TIMES

T = TypeVar("T")
PATIENCE_S = 300.0
LOOK_S = 0.005
SIGMAS = (0.1, 0.2, 0.3, 0.4)
WITH_TRUTH = "truth.aligned_rmse_m"


def recording(folder: Path, name: str = "short.bag", duration: float = 3.0, seed: int = 1) -> Path:
    """Some simulated seconds in the rooms, with their truth."""
    path = folder / name
    simulate(SimulateOptions(scenario="rooms", out=path, duration=duration, scan_rate=20.0, beams=181, seed=seed))
    return path


def specs_of(*paths: Path, sigmas: tuple[float, ...] = SIGMAS) -> list[RunSpec]:
    """Every recording with every sigma."""
    return [RunSpec(path.name, str(path), {"matcher.sigma": sigma}) for path in paths for sigma in sigmas]


def timeless(folder: Path) -> list[list[str]]:
    """The cells of runs.csv, in its order, without those that are times."""
    with (folder / CSV).open(newline="") as file:
        rows = list(csv.reader(file))
    kept = [k for k, name in enumerate(rows[0]) if name not in TIMES]
    return [[row[k] for k in kept] for row in rows]


def children(process: int | str = "self") -> set[int]:
    """The processes that one has started and that live."""
    lists = Path(f"/proc/{process}/task").glob("*/children")
    return {int(pid) for each in lists for pid in each.read_text().split()}


def until(found: Callable[[], T | None]) -> T:
    """What `found` gives once that is something."""
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        if there := found():
            return there
        time.sleep(LOOK_S)
    raise AssertionError("never happened")
