"""How long the sweep of a laser takes, by how well its scans fit: for messages that give no time_increment.

    python -m benchmarks.sweep_time

Each recording is run as if its sweeps took a share of the time between two scans, with their middle where it is
stamped; of a negative share the beams run against their order. Prints the mean residual of the matches, share by
share, and where there is a truth the aligned error in millimetres with the shift of the truth that suits best.
"""

import argparse
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor

import numpy as np

from benchmarks.accuracy import process
from benchmarks.cases import REAL, present
from benchmarks.truth_offset import SHIFTS, errors
from hectorscope.checks.beam_times import centred
from hectorscope.run.series import SERIES_DTYPE
from hectorscope.run.warmup import load_everything
from hectorscope.sources import open_source
from slam_core.config import SlamConfig, with_values
from slam_core.evaluation.trajectory import Trajectory
from slam_core.measurements import LaserScan

SHARES = (-1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0)
PROCESSES = 2


def run(number: int, share: float) -> tuple[float, float, float]:
    """Of one recording: the share that its messages state, mean residual, and error in metres (NaN: no truth)."""
    recording = present(REAL)[number]
    items = list(open_source(str(recording.path), recording.options).items())
    scans = [item for item in items if isinstance(item, LaserScan)]
    period_s = float(np.median(np.diff([scan.stamp_ns for scan in scans]))) * 1e-9
    circle = min(abs(scans[0].angle_increment) * len(scans[0].ranges) / (2.0 * np.pi), 1.0)
    sweep_s = share * circle * period_s
    changed = (centred(item, item.stamp_ns, sweep_s) if isinstance(item, LaserScan) else item for item in items)
    pipeline = process(changed, with_values(SlamConfig(), dict(recording.settings)))
    residual = float(np.nanmean(pipeline.series.view(SERIES_DTYPE).reshape(-1)["residual"]))
    stated = scans[0].time_increment * len(scans[0].ranges) / (circle * period_s)
    if not len(pipeline.truth):
        return stated, residual, np.nan
    ours, truth = Trajectory.from_rows(pipeline.trajectory), Trajectory.from_rows(pipeline.truth)
    return stated, residual, min(errors(ours, truth, shift, with_lever=False)[0] for shift in SHIFTS)


def line(name: str, outcomes: Sequence[tuple[float, float, float]]) -> str:
    """One recording."""
    cells = (f"{residual:.3f}" + ("" if np.isnan(e) else f" {1e3 * e:4.1f}") for _, residual, e in outcomes)
    return f"{name:>24} | {outcomes[0][0]:5.2f} | " + " | ".join(cells)


def main() -> None:
    """Print a line for each recording."""
    argparse.ArgumentParser(description=__doc__.splitlines()[0]).parse_args()
    print(f"{'share of the period':>24} | given | " + " | ".join(f"{share:5.2f}" for share in SHARES))
    with ProcessPoolExecutor(PROCESSES, initializer=load_everything) as pool:
        for number, recording in enumerate(present(REAL)):
            futures = [pool.submit(run, number, share) for share in SHARES]
            print(line(recording.name, [each.result() for each in futures]), flush=True)


if __name__ == "__main__":
    main()
