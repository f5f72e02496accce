"""Whether the consistency score orders runs as the truth does: rank correlation over settings, good and bad.

    python -m benchmarks.sweeps.score [--settings 30] [--write]

Each recording with a truth is run with the defaults, the paper's method, and settings drawn from wide ranges, many
of them of no use. --write keeps the table in docs/sweeps.md.
"""

import argparse
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.cases import DEMOS, REAL, Recording, present
from benchmarks.sweeps.cases import base_of
from benchmarks.sweeps.marks import fill
from benchmarks.tables import table
from hectorscope.sweep.executors import executor
from hectorscope.sweep.limits import Limits
from hectorscope.sweep.plan import with_setting
from hectorscope.sweep.search import quasi_random
from hectorscope.sweep.spec import RunSpec
from hectorscope.sweep.sweep import sweep
from hectorscope.sweep.table import Row, Table
from hectorscope.sweep.vary import parse
from slam_core.config.presets import PAPER
from slam_core.measurements import Float64s
from tests.conftest import ROOT

SETTINGS, SEED = 30, 3
VARY = (
    "fusion.omega=0.001:0.9:log",
    "matcher.sigma=0.01:5:log",
    "map.update_distance=0.05:3:log",
    "matcher.iterations_fine=1:10",
    "map.levels=1:4",
    "map.resolution=0.03:0.15:log",
    "tracking.check=true,false",
    "scan.deskew=true,false",
    "scan.stabilise=true,false",
    "map.factor_behind=0.05:0.5",
)
SCORE, TRUTH = "consistency", "truth.aligned_rmse_m"
WITHOUT = ("hallway eng403_good", "ccny_handheld", "mumble kitchen_1")  # no truth


def specs_of(recording: Recording, count: int) -> list[RunSpec]:
    """The defaults, the paper, and what is drawn."""
    base, axes = base_of(recording), [parse(text) for text in VARY]
    drawn = [with_setting(base, values) for values in quasi_random(axes, count - 2, SEED)]
    return [base, replace(base, settings={**base.settings, **PAPER}), *drawn]


def ranks(values: Float64s) -> Float64s:
    """From 0 on; equal values share the mean of their ranks."""
    below = (values[:, None] > values).sum(axis=1)
    same = (values[:, None] == values).sum(axis=1)
    ranked: Float64s = below + (same - 1) / 2.0
    return ranked


def rank_correlation(a: Float64s, b: Float64s) -> float:
    """Spearman's: that of the ranks."""
    return float(np.corrcoef(ranks(a), ranks(b))[0, 1])


def line(name: str, rows: list[Row]) -> list[str]:
    """Of the table: the correlation, and the error of the run that the score likes best beside the least."""
    found = [row for row in rows if row[SCORE] and row[TRUTH]]
    score, error = (np.array([float(row[column]) for row in found]) for column in (SCORE, TRUTH))
    chosen, least, usual = error[np.argmax(score)], error.min(), error[0]
    rho = rank_correlation(score, -error)
    return [
        name, str(len(found)), f"{error.min():.3f} to {error.max():.3g} m", f"{rho:.2f}",
        f"{chosen:.3f} m", f"{least:.3f} m", f"{usual:.3f} m", f"{np.median(error):.3f} m",
    ]  # fmt: skip


HEAD = (
    "recording", "runs", "errors", "rank correlation", "error of the best score", "least error", "of the defaults",
    "median",
)  # fmt: skip


def main() -> None:
    """Sweep, and compare."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--settings", type=int, default=SETTINGS)
    parser.add_argument("--write", action="store_true")
    args = parser.parse_args()
    compared = [each for each in present((*DEMOS, *REAL)) if each.name not in WITHOUT]
    lines = []
    with tempfile.TemporaryDirectory() as made, executor(0) as pool:
        for recording in compared:
            specs, folder = specs_of(recording, args.settings), Path(made) / recording.path.stem
            folder.mkdir()
            rows = Table(folder, [])
            sweep(specs, rows, pool, Limits(time_s=300.0))
            rows.finish(specs)
            lines.append(line(recording.name, list(rows.rows.values())))
            print(*lines[-1], sep=" | ", flush=True)
    text = table(HEAD, lines)
    if args.write:
        fill(ROOT / "docs" / "sweeps.md", "score", text)


if __name__ == "__main__":
    main()
