"""What tests of sweeps share: a short recording, specs on it, and the table without its times."""

import csv
import os
import subprocess
import sys
from pathlib import Path

from hectorscope.simulation import SimulateOptions, simulate
from hectorscope.sweep.spec import RunSpec
from hectorscope.sweep.table import CSV, TIMES

PATIENCE_S = 300.0
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


def hectorscope(*arguments: object) -> subprocess.CompletedProcess[str]:
    """The command in a process of its own."""
    command = [sys.executable, "-m", "hectorscope.cli.main", *map(str, arguments)]
    wide = {**os.environ, "COLUMNS": "160"}
    return subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S, env=wide, check=False)
