"""How late the truth of a recording is against its scans, and where its marker sits on the base.

    python -m benchmarks.truth_offset

A shift of the truth in time and a marker off the origin of the base look like errors of the trajectory. Prints the
aligned error as it is, with the best shift, with the best lever arm, and with both.
"""

import argparse

import numpy as np

from benchmarks.accuracy import process
from benchmarks.cases import REAL, Recording, present
from hectorscope.sources import open_source
from slam_core.config import SlamConfig, with_values
from slam_core.evaluation.trajectory import Trajectory, align, interpolate, move, rms
from slam_core.measurements import Float64s

SHIFTS = np.arange(-0.3, 0.3001, 0.005)  # s, added to the times of the truth
ROUNDS = 10  # of alignment and lever arm in turn


def errors(ours: Trajectory, truth: Trajectory, shift: float, *, with_lever: bool) -> tuple[float, Float64s]:
    """Aligned error in metres, and the lever arm (2,) of the marker in the axes of the base, metres."""
    late = Trajectory(truth.times + shift, truth.positions, truth.rotations)
    reference, covered = interpolate(late, ours.times)
    planar, there = ours.select(covered).planar, reference.planar[:, :2]
    lever = np.zeros(2)
    cosine, sine = np.cos(planar[:, 2]), np.sin(planar[:, 2])
    turns = np.stack([np.stack([cosine, -sine], axis=-1), np.stack([sine, cosine], axis=-1)], axis=-2)
    for _ in range(ROUNDS if with_lever else 1):
        marker = planar[:, :2] + turns @ lever
        aligned = move(align(there, marker), np.column_stack([there, np.zeros(len(there))]))[:, :2]
        if with_lever:
            apart = np.einsum("nji,nj->ni", turns, aligned - planar[:, :2])
            lever = apart.mean(axis=0)
    return rms(np.hypot(*(marker - aligned).T)), lever


def rows(recording: Recording) -> list[str]:
    """A line for each assumption."""
    source = open_source(str(recording.path), recording.options)
    pipeline = process(source.items(), with_values(SlamConfig(), dict(recording.settings)))
    if not len(pipeline.truth):
        return []
    ours, truth = Trajectory.from_rows(pipeline.trajectory), Trajectory.from_rows(pipeline.truth)
    lines = []
    for with_lever in (False, True):
        found = [errors(ours, truth, shift, with_lever=with_lever) for shift in SHIFTS]
        best = int(np.argmin([error for error, _ in found]))
        for what, k in (("as stamped", int(np.argmin(np.abs(SHIFTS)))), (f"{1e3 * SHIFTS[best]:+.0f} ms", best)):
            error, (x, y) = found[k]
            lines.append(f"{recording.name}: truth {what}, marker at {x:.3f} {y:.3f} m: {1e3 * error:.1f} mm")
    return lines


def main() -> None:
    """Print the lines of every recording with a truth."""
    argparse.ArgumentParser(description=__doc__.splitlines()[0]).parse_args()
    for recording in present(REAL[:3]):
        for line in rows(recording):
            print(line, flush=True)


if __name__ == "__main__":
    main()
