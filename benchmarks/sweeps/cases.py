"""The recordings of benchmarks/cases.py as specs of a sweep, and relations from their truth."""

from dataclasses import fields
from pathlib import Path

import numpy as np

from benchmarks.cases import BESIDE, Recording
from hectorscope.sources import open_source
from hectorscope.sweep.spec import RunSpec
from slam_core.evaluation.trajectory import Trajectory, between, path_length
from slam_core.measurements import Float64s, TruthPose

STRETCH = 2.0  # m of the true path between the two poses of a relation
EVERY = 0.25  # m of it from one relation to the next
PUBLISHED = BESIDE / "relations"  # NAME.relations there, of the recording NAME.clf or the like, goes first


def base_of(recording: Recording) -> RunSpec:
    """What is stated of a recording and its devices, as a spec."""
    values = {field.name: getattr(recording.options, field.name) for field in fields(recording.options)}
    options = {name: value for name, value in values.items() if value is not None}
    return RunSpec(recording.name, str(recording.path), dict(recording.settings), options=options)


def relations_of(recording: Recording, folder: Path) -> tuple[Path, str] | None:
    """A file of relations and where they are from: published ones, else written from the truth; None without."""
    published = PUBLISHED / f"{recording.path.stem}.relations"
    if published.exists():
        return published, "published"
    rows = truth_rows(recording)
    lines = relation_lines(rows) if len(rows) else []
    if not lines:
        return None
    path = folder / f"{recording.path.stem}.relations"
    path.write_text("".join(lines), encoding="utf-8")
    return path, "from the truth"


def truth_rows(recording: Recording) -> Float64s:
    """(n, 8) poses of the truth, times in seconds as stamped."""
    source = open_source(str(recording.path), recording.options)
    poses = [item for item in source.items() if isinstance(item, TruthPose)]
    source.close()
    rows = [
        (pose.stamp_ns / 1e9, *pose.T_map_base.translation.tolist(), *pose.T_map_base.rotation.tolist())
        for pose in poses
    ]
    return np.array(rows).reshape(-1, 8)


def relation_lines(rows: Float64s) -> list[str]:
    """Relations between poses (n, 8) that are STRETCH apart along the path, one every EVERY."""
    truth = Trajectory.from_rows(rows)
    along = path_length(truth.positions[:, :2])
    begins = np.unique(np.searchsorted(along, np.arange(0.0, along[-1], EVERY)))
    ends = np.searchsorted(along, along[begins] + STRETCH)
    begins, ends = begins[ends < len(along)], ends[ends < len(along)]
    motions = between(truth.planar[begins], truth.planar[ends])
    times = np.column_stack([truth.times[begins], truth.times[ends]])
    return [
        f"{begin:.9f} {end:.9f} {x:.6f} {y:.6f} 0 0 0 {yaw:.6f}\n"
        for (begin, end), (x, y, yaw) in zip(times.tolist(), motions.tolist(), strict=True)
    ]
