"""Runs every configuration over every case and seed, and keeps the figures in a file of JSON lines."""

import hashlib
import json
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import ghosts, returning
from benchmarks.additions.cases import PEOPLE, Case, cases
from benchmarks.additions.catalogue import CONFIGURATIONS, FULL, LAST_POSE, MEASURED, PAPER, scope
from hectorscope.inputs import Item
from hectorscope.run.metrics import truth_errors
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.series import SERIES_DTYPE
from hectorscope.run.warmup import load_everything
from hectorscope.simulation import Simulation
from slam_core.config import with_values
from slam_core.evaluation.trajectory import Trajectory, first_on_first, interpolate, move
from tests.conftest import ROOT

STORE = ROOT / "build" / "additions.jsonl"
PROCESSES = 2
PAPER_SEEDS = 6  # of the paper's method, which is far from the defaults
SMALL = 0.02  # of the error: a smaller difference is next to nothing
DECIDED = 6  # seeds that all differ by more, and in the same direction
PROBED = 3  # seeds after which an addition that changed nothing in a case is not run there any more
LAST_S = 2.0  # seconds of which the error at the end is the mean
GHOSTLY = (FULL, "map.clear_interval", "map.appearance_delay", PAPER)  # configurations that are watched for ghosts

Key = tuple[str, str, int, str]
"""Family, name and seed of a case, and the configuration."""
Figures = dict[str, Any]


def key(row: Mapping[str, Any]) -> Key:
    """What a row is the figures of."""
    return row["family"], row["case"], row["seed"], row["config"]


def load(path: Path = STORE) -> dict[Key, Figures]:
    """The rows that are there."""
    if not path.exists():
        return {}
    rows = (json.loads(line) for line in path.read_text(encoding="utf-8").splitlines())
    return {key(row): row for row in rows}


def wanted(case: Case) -> list[str]:
    """The configurations that may differ in a case, the defaults first."""
    at_fault = case.family.startswith(("faults", "outages"))
    names = [addition.name for addition in MEASURED]
    acting = [n for n in names if scope(n).needs <= case.tags and not (at_fault and scope(n).accuracy)]
    return [FULL, PAPER, *([] if at_fault else [LAST_POSE]), *acting]


def run_missing(seeds: int, path: Path = STORE) -> None:
    """Every run that is not in the file yet, seed by seed."""
    path.parent.mkdir(exist_ok=True)
    begin, rows, every = time.monotonic(), load(path), cases()
    with (
        ProcessPoolExecutor(PROCESSES, initializer=load_everything) as pool,
        path.open("a", encoding="utf-8") as file,
    ):
        for seed in range(1, seeds + 1):
            todo = {i: missing(case, seed, rows) for i, case in enumerate(every)}
            together: dict[str, dict[int, tuple[list[str], list[str]]]] = {}
            for i, names in todo.items():
                if names:
                    idle = [name for name in names if is_idle(every[i], name, rows)]
                    together.setdefault(every[i].base or every[i].name, {})[i] = names, idle
            futures = {pool.submit(job, work, seed): base for base, work in together.items()}
            for done, future in enumerate(as_completed(futures), start=1):
                for row in future.result():
                    rows[key(row)] = row
                    file.write(json.dumps(row) + "\n")
                file.flush()
                minutes = (time.monotonic() - begin) / 60
                print(f"seed {seed}, {done}/{len(futures)}, {minutes:.1f} min: {futures[future]}", flush=True)


def missing(case: Case, seed: int, rows: Mapping[Key, Figures]) -> list[str]:
    """The configurations of a case and seed that are not there."""
    if seed > case.seeds:
        return []
    names = [name for name in wanted(case) if name not in {PAPER, LAST_POSE} or seed <= PAPER_SEEDS]
    absent = [name for name in names if (case.family, case.name, seed, name) not in rows]
    unwatched = [
        name for name in names if case.ghosts and name in GHOSTLY and not is_watched(case, seed, name, rows)
    ]
    due = [name for name in absent if name == FULL or not is_settled(case, name, rows)]
    return list(dict.fromkeys(due + unwatched))


def is_watched(case: Case, seed: int, name: str, rows: Mapping[Key, Figures]) -> bool:
    """Whether the ghosts of a run were counted."""
    return "ghosts" in rows.get((case.family, case.name, seed, name), {})


def is_settled(case: Case, name: str, rows: Mapping[Key, Figures]) -> bool:
    """Whether further seeds tell nothing new: all differ by next to nothing, or in the same direction."""
    without = {row["seed"]: row[case.figure] for row in rows_of(rows, case, name)}
    full = {row["seed"]: row[case.figure] for row in rows_of(rows, case, FULL)}
    pairs = [(without[seed], full[seed]) for seed in without if seed in full]
    ratios = [off / on for off, on in pairs if off is not None and on]
    same = {row["bytes"] for row in rows_of(rows, case, FULL)}
    copied = any(row.get("copied") or row["bytes"] in same for row in rows_of(rows, case, name))
    if len(ratios) >= DECIDED and (min(ratios) > 1.0 + SMALL or max(ratios) < 1.0 - SMALL):
        return True
    return not copied and len(ratios) >= PROBED and all(abs(ratio - 1.0) < SMALL for ratio in ratios)


def is_idle(case: Case, name: str, rows: Mapping[Key, Figures]) -> bool:
    """Whether an addition changed not one byte of the trajectory in the first seeds: it is not run again there."""
    without, full = (list(rows_of(rows, case, each))[:PROBED] for each in (name, FULL))
    if len(without) < PROBED or len(full) < PROBED or name in {FULL, PAPER, LAST_POSE}:
        return False
    return all(a["bytes"] == b["bytes"] for a, b in zip(without, full, strict=True))


def job(work: Mapping[int, tuple[Sequence[str], Sequence[str]]], seed: int) -> list[Figures]:
    """Cases that share a simulation, by several configurations; those that are idle get what the defaults got."""
    every = cases()
    return [row for i, (names, idle) in work.items() for row in _case(every[i], seed, names, idle)]


def _case(case: Case, seed: int, configurations: Sequence[str], idle: Sequence[str]) -> list[Figures]:
    items = case.load(seed)
    names = {"family": case.family, "case": case.name, "seed": seed}
    full = _measured(case, items, seed, FULL)
    rows: list[Figures] = []
    for name in configurations:
        if name == FULL:
            figures = full
        elif not _acts(name, case, full) or (name in idle and not scope(name).after & full["states"].keys()):
            figures = {**full, "copied": True}
        else:
            figures = _measured(case, items, seed, name)
        rows.append({**names, "config": name, **figures})
    return rows


def _acts(name: str, case: Case, full: Figures) -> bool:
    """Whether an addition can have changed anything in the run with the defaults."""
    where = scope(name)
    if not where.after or (where.surprised and "unaided" in case.tags):
        return True
    return bool(where.after & full["states"].keys())


def _measured(case: Case, items: Sequence[Item], seed: int, name: str) -> Figures:
    config = with_values(CONFIGURATIONS[name], case.settings)
    if case.ghosts and name in GHOSTLY:
        scene = Simulation("people", replace(PEOPLE, seed=seed)).scene
        watch, pipeline = ghosts.watched(scene, items, config)
        return {**figures_of(pipeline), "ghosts": watch.ghosts, "longest": watch.longest}
    pipeline, returned = returning.process(items, config)
    return {**figures_of(pipeline), "off_map": None if returned is None else 1.0 - returned}


def figures_of(pipeline: Pipeline) -> Figures:
    """Errors in metres and degrees if there is a truth; tracking states; median microseconds of a match."""
    trajectory = pipeline.trajectory
    series = pipeline.series.view(SERIES_DTYPE).reshape(-1)
    first, last = trajectory[[0, -1], 1:3]
    errors = (truth_errors(pipeline.trajectory, pipeline.truth) if len(pipeline.truth) else None) or {}
    worst, end = _over_time(pipeline) if errors else (None, None)
    return {
        "raw": errors.get("raw_rmse_m"),
        "aligned": errors.get("aligned_rmse_m"),
        "height": errors.get("height_rms_m"),
        "roll": errors.get("roll_rms_deg"),
        "pitch": errors.get("pitch_rms_deg"),
        "worst": worst,
        "end": end,
        "start_to_end": float(np.hypot(*(last - first))),
        "scans": pipeline.scans,
        "states": dict(pipeline.states),
        "match_us": 1e3 * float(np.median(series["match_ms"])),
        "iterations": float(np.mean(series["iterations"])),
        "residual": float(np.nanmean(series["residual"])),
        "bytes": hashlib.sha1(trajectory.tobytes()).hexdigest()[:12],
    }


def _over_time(pipeline: Pipeline) -> tuple[float, float]:
    """Largest planar error, and the mean of those at the end, with the first poses laid on each other."""
    truth, covered = interpolate(Trajectory.from_rows(pipeline.truth), pipeline.trajectory[:, 0])
    ours = Trajectory.from_rows(pipeline.trajectory[covered])
    there = move(first_on_first(truth.planar, ours.planar), truth.planar)
    errors = np.hypot(*(ours.planar - there)[:, :2].T)
    late = ours.times >= ours.times[-1] - LAST_S
    return float(errors.max()), float(errors[late].mean())


def rows_of(rows: Mapping[Key, Figures], case: Case, name: str) -> Iterator[Figures]:
    """The rows of a case by one configuration, in the order of the seeds."""
    for seed in range(1, case.seeds + 1):
        row = rows.get((case.family, case.name, seed, name))
        if row is not None:
            yield row
