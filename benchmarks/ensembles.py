"""How dependable runs are: each recording and simulated scene in variants that differ by next to nothing.

    python -m benchmarks.ensembles [NAME ...] [--variants 20] [--set map.wall_gap=0 ...] [--write]

Variants have 3 mm of noise on every range and are without some first scans; one in three is without every tenth
scan, another third has stamps that jitter by 2 ms. --write keeps the table in docs/ensembles.md.
"""

import argparse
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, replace
from statistics import median
from typing import Any

import numpy as np

from benchmarks.cases import LOST_M
from benchmarks.ensemble_cases import cases
from benchmarks.tables import table
from hectorscope.inputs import Item
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.run.warmup import load_everything
from slam_core.config import SlamConfig, with_values
from slam_core.evaluation.trajectory import (
    Trajectory,
    align,
    first_on_first,
    interpolate,
    move,
    path_length,
    relative_errors,
    rms,
)
from slam_core.measurements import Float64s, LaserScan
from slam_core.results import StepResult
from tests.conftest import ROOT

VARIANTS = 20
RANGE_NOISE, JITTER_NS = 0.003, 2_000_000  # m; ns
MOST_DROPPED = 20  # scans that a variant leaves out at the start
EVERY = 10  # scans, of which a variant leaves one out
STRETCH = 5.0  # m of path over which a relation is compared
SLIDE_S, SLIDE_M = 2.0, 0.1  # a motion over so many seconds that is wrong by more is a slide
PROCESSES = 2
SURE = ("tracking", "recovered")


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """poses: (n, 4) seconds since the start of the recording, x, y, yaw. truth: (n, 3) where there is one, else
    None. sure, written: (n,).
    """

    poses: Float64s
    truth: Float64s | None
    sure: np.ndarray
    written: np.ndarray
    lost_at_the_end: bool


@dataclass(frozen=True, slots=True)
class Outcome:
    """error, relation: metres, root mean square and mean. The rest: whether it happened to a variant.

    lost: further off than LOST_M at the end or lost there. misplaced: a scan was written so far off. silent: so
    far off at a scan that was not called degraded or lost. slides: scans from which on the motion over SLIDE_S is
    wrong by more than SLIDE_M.
    """

    error: float
    relation: float
    lost: bool
    misplaced: bool
    silent: bool
    slides: int


def varied(items: Iterable[Item], variant: int) -> Iterator[Item]:
    """The items of a variant; those of variant 1 are as they were."""
    rng = np.random.default_rng([variant, 25])
    left_out, k = int(rng.integers(1, MOST_DROPPED + 1)), 0
    last, noise = np.empty(0, np.float32), np.empty(0)
    for item in items:
        if not isinstance(item, LaserScan) or variant == 1:
            yield item
            continue
        k += 1
        if k <= left_out or (variant % 3 == 0 and k % EVERY == 0):
            continue
        if not np.array_equal(item.ranges, last, equal_nan=True):  # what a driver sends again has the same noise
            last, noise = item.ranges, RANGE_NOISE * rng.standard_normal(len(item.ranges))
        late_ns = int(rng.normal(scale=JITTER_NS)) if variant % 3 == 1 else 0
        yield replace(
            item, ranges=(item.ranges + noise).astype(np.float32), stamp_ns=max(0, item.stamp_ns + late_ns)
        )


def follow(items: Iterable[Item], config: SlamConfig, start_ns: int) -> Run:
    """A whole run, scan by scan. start_ns: of the recording; a variant may begin later."""
    pipeline, results = Pipeline(Settings(config), start_ns), list[StepResult]()

    def step(measurements: Sequence[Any]) -> None:
        results.extend(result for each in measurements if (result := pipeline.step(each)))

    for item in items:
        step(pipeline.admit(item))
    step(pipeline.flush())
    ours = Trajectory.from_rows(pipeline.trajectory)
    poses = np.column_stack([ours.times, ours.planar])
    sure = np.array([result.verdict.state in SURE for result in results])
    written = np.array([result.map_updated for result in results])
    truth = None
    if len(pipeline.truth):
        reference, covered = interpolate(Trajectory.from_rows(pipeline.truth), ours.times)
        poses, sure, written, truth = poses[covered], sure[covered], written[covered], reference.planar
    return Run(poses, truth, sure, written, not sure[-LOST_SCANS:].any())


LOST_SCANS = 20  # without one that was tracked, at the end


def run(name: str, variant: int, settings: Mapping[str, Any]) -> Run:
    """A variant of a case."""
    case = next(case for case in cases() if case.name == name)
    items = case.load(variant if case.seeded else 1)
    config = with_values(SlamConfig(), {**case.settings, **settings})
    return follow(varied(items, variant), config, items[0].stamp_ns)


def outcomes(runs: Sequence[Run]) -> list[Outcome]:
    """Of the variants of a case; without a truth, the run that the others are nearest to takes its place."""
    if runs[0].truth is not None:
        return [_outcome(each, each.truth) for each in runs if each.truth is not None]
    distances = np.array([[_distance(a, b) for b in runs] for a in runs])
    best = runs[int(np.argmin(np.median(distances, axis=1)))]
    return [_outcome(each, _at(best, each.poses[:, 0])) for each in (_during(best, run) for run in runs)]


def _distance(a: Run, b: Run) -> float:
    a = _during(b, a)
    there = _at(b, a.poses[:, 0])
    moved = move(align(there[:, :2], a.poses[:, 1:3]), there)
    return rms(np.hypot(*(a.poses[:, 1:3] - moved[:, :2]).T))


def _during(other: Run, run: Run) -> Run:
    """What a run has between the first and the last pose of another."""
    times = run.poses[:, 0]
    covered = (other.poses[0, 0] <= times) & (times <= other.poses[-1, 0])
    return replace(run, poses=run.poses[covered], sure=run.sure[covered], written=run.written[covered])


def _at(run: Run, times: Float64s) -> Float64s:
    """(n, 3) planar poses of a run at other times."""
    t, x, y, yaw = run.poses.T
    return np.column_stack([np.interp(times, t, each) for each in (x, y, np.unwrap(yaw))])


def _outcome(run: Run, truth: Float64s) -> Outcome:
    ours = run.poses[:, 1:]
    there = move(align(truth[:, :2], ours[:, :2]), truth)
    raw = move(first_on_first(truth, ours), truth)
    away = np.minimum(*(np.hypot(*(ours - each)[:, :2].T) for each in (there, raw)))
    relations = relative_errors(ours, truth, path_length(truth[:, :2]), STRETCH)
    motions = relative_errors(ours, truth, run.poses[:, 0], SLIDE_S)
    off = away > LOST_M
    return Outcome(
        rms(np.hypot(*(ours - there)[:, :2].T)),
        float(np.mean(np.hypot(*relations[:, :2].T))) if len(relations) else 0.0,
        lost=bool(run.lost_at_the_end or off[-LOST_SCANS:].all()),
        misplaced=bool((off & run.written).any()),
        silent=bool((off & run.sure).any()),
        slides=int((np.hypot(*motions[:, :2].T) > SLIDE_M).sum()),
    )


HEAD = (
    "case",
    "variants",
    "error, median",
    "worst",
    "relations, median",
    "worst",
    "lost",
    "written wrong",
    "silent",
)


def row(name: str, found: Sequence[Outcome]) -> list[str]:
    """Of the table."""
    errors, relations = ([getattr(each, key) for each in found] for key in ("error", "relation"))
    cells = [f"{f(values):.3f} m" for values in (errors, relations) for f in (median, max)]
    counts = [str(sum(getattr(each, key) for each in found)) for key in ("lost", "misplaced", "silent")]
    return [name, str(len(found)), *cells, *counts]


def main() -> None:
    """Run the variants, and print a row for each case."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="parts of the names of cases; all of them without one")
    parser.add_argument("--variants", type=int, default=VARIANTS)
    parser.add_argument("--set", nargs="*", default=[], metavar="NAME=VALUE", help="settings that differ")
    parser.add_argument("--write", action="store_true", help="write docs/ensembles.md")
    args = parser.parse_args()
    settings = {name: _value(text) for name, _, text in (each.partition("=") for each in args.set)}
    chosen = [each.name for each in cases() if not args.names or any(part in each.name for part in args.names)]
    rows = []
    with ProcessPoolExecutor(PROCESSES, initializer=load_everything) as pool:
        for name in chosen:
            begin = time.monotonic()
            futures = {pool.submit(run, name, k, settings): k for k in range(1, args.variants + 1)}
            runs = {futures[each]: each.result() for each in as_completed(futures)}
            found = outcomes([runs[k] for k in sorted(runs)])
            rows.append(row(name, found))
            bad = [k for k, each in zip(sorted(runs), found, strict=True) if each.lost or each.misplaced]
            print(
                *rows[-1], f"bad {bad}" if bad else "", f"{time.monotonic() - begin:.0f} s", sep=" | ", flush=True
            )
    if args.write:
        (ROOT / "docs" / "ensembles.md").write_text(f"{INTRODUCTION}\n{table(HEAD, rows)}", encoding="utf-8")


def _value(text: str) -> float | bool | str:
    if text in {"true", "false"}:
        return text == "true"
    try:
        return float(text) if "." in text or "e" in text else int(text)
    except ValueError:
        return text


INTRODUCTION = """# How dependable runs are

Written by `python -m benchmarks.ensembles --write`. Each case is run in variants: 3 mm of noise on every range
and without some of the first 20 scans; one variant in three is without every tenth scan, another third has
stamps that jitter by 2 ms. A simulated case has other noise and other people in each variant. Errors, median
and worst, are those of positions after alignment, root mean square; relations are mean errors of the motion
over 5 m of path. *Lost*: more than 1 m off, or lost, at the end. *Written wrong*: a scan was written into the
map more than 1 m off. *Silent*: more than 1 m off at a scan that was called tracked. Where there is no truth,
the run that the others are nearest to takes its place.
"""

if __name__ == "__main__":
    main()
