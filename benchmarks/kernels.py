"""What the parts of a step cost, in process, on a simulated run through rooms of 30 x 20 m; and how that grows.

    python -m benchmarks.kernels [--seconds 60] [--seed 1] [--only-pose]

A beam evaluation is one endpoint's share of eqs. (11) and (13): place it, interpolate, add up. It is measured on
every beam sixteen times over, so that the call itself hardly counts. --only-pose leaves inertial data out.
"""

import argparse
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from multiprocessing import get_context
from typing import NamedTuple

import numpy as np

from benchmarks.cases import DEMOS, Recording, present
from benchmarks.tables import table
from hectorscope.inputs import Item
from hectorscope.run.warmup import load_everything
from hectorscope.simulation import SceneOptions, Simulation
from hectorscope.sources import open_source
from slam_core.config import MapConfig, MatcherConfig, SlamConfig
from slam_core.kernels.planar import transform_points
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.matcher import beams_of, coarse_to_fine, normal_equations
from slam_core.measurements import Height, Imu, Int64s, Measurement, TruthPose
from slam_core.results import Durations, StepResult
from slam_core.sequencer import Sequencer
from slam_core.slam import HectorSlam

REPEATS = 200
TILES = 16
ROUNDS, LOOKS, PAUSE_S = 3, 4, 2.0  # a shared machine is slower for seconds on end, and for minutes
DRIVE_S = 60.0  # as long as the recordings that come with the project
ROOMS = "rooms"
BEAMS, LEVELS, SIZES = (271, 541, 1081, 2161), (1, 2, 3, 4, 5), (512, 1024, 2048, 4096)
SCALING_S = 8.0  # of the drive: what it has seen by then is larger than a scan's reach
OFF = np.array([0.03, -0.02, 0.01])  # of the start estimate
LASER, NONE = np.zeros(2), np.empty((0, 2), np.float32)

Part = tuple[str, float, str]  # name, value, unit
Load = Callable[[], list[Measurement]]


def microseconds(call: Callable[[], object], repeats: int = REPEATS) -> float:
    """Median duration of a call."""
    times = np.empty(repeats)
    for k in range(repeats):
        begin = time.perf_counter_ns()
        call()
        times[k] = time.perf_counter_ns() - begin
    return float(np.median(times)) * 1e-3


def measurements(options: SceneOptions, only_pose: bool = False) -> Iterator[Measurement]:
    """Of the rooms, scans and, unless left out, inertial data."""
    items = Simulation("rooms", options).items()
    return in_order(item for item in items if not (only_pose and isinstance(item, Imu | Height)))


def in_order(items: Iterable[Item]) -> Iterator[Measurement]:
    """What items give to the pipeline, in the order of a Sequencer."""
    sequencer = Sequencer()
    for item in items:
        if not isinstance(item, TruthPose):
            yield from sequencer.push(item)
    yield from sequencer.flush()


class Run(NamedTuple):
    """spent: (n,) nanoseconds of every measurement. durations, written: of every scan; last: the last result."""

    spent: Int64s
    durations: list[Durations]
    written: list[bool]
    last: StepResult


def run(slam: HectorSlam, recording: list[Measurement]) -> Run:
    """The whole recording. As in the application, no result but the last is kept."""
    durations, written, last = [], [], None
    spent = np.empty(len(recording), np.int64)
    for i, measurement in enumerate(recording):
        begin = time.perf_counter_ns()
        result = slam.step(measurement)
        spent[i] = time.perf_counter_ns() - begin
        if result is not None:
            durations.append(result.durations)
            written.append(result.map_updated)
            last = result
    assert last is not None
    return Run(spent, durations, written, last)


def steps(done: Run) -> Iterator[Part]:
    """Medians of the parts of a step, and scans a second of what other systems count."""
    for part in ("stabilise", "filter", "match"):
        yield part, float(np.median([getattr(each, part) for each in done.durations])) * 1e-3, "us"
    updates = [each.update for each, written in zip(done.durations, done.written, strict=True) if written]
    yield f"map update, {len(updates)} of {len(done.durations)} scans", float(np.median(updates)) * 1e-3, "us"
    alone = [each.match + each.update for each in done.durations]
    yield "match and map alone, as others are measured", 1e9 / float(np.mean(alone)), "scans/s"


def kernels(slam: HectorSlam, scan: StepResult) -> Iterator[Part]:
    """One scan matched and written again and again, on a copy of the map."""
    pyramid = slam.map.copy()
    many, level = np.tile(scan.points, (TILES, 1)), pyramid.levels[0]
    evaluation = microseconds(partial(normal_equations, level, beams_of(many), scan.planar))
    yield "beam evaluation", evaluation * 1e3 / len(many), "ns"
    by_cells = match(pyramid, scan, MatcherConfig(surfel_weight=0.0))
    yield f"match of one scan from 4 cm off, {len(scan.points)} beams", match(pyramid, scan, MatcherConfig()), "us"
    yield "the same by cells alone", by_cells, "us"
    yield f"update of {len(pyramid.levels)} levels by one scan", update(pyramid, scan, slam.config.map), "us"
    placed = transform_points(scan.planar, scan.points)
    surfels = partial(level.place_surfaces, scan.points, scan.planar[:2], placed, scan.planar[2])
    yield "of that, the surfels", microseconds(surfels), "us"
    yield "memory of a cell, all in", memory(pyramid) / cells(pyramid), "bytes"


def match(pyramid: Pyramid, scan: StepResult, config: MatcherConfig) -> float:
    """Microseconds of a match of `scan`."""
    return microseconds(partial(coarse_to_fine, pyramid, scan.points, scan.planar + OFF, config))


def update(pyramid: Pyramid, scan: StepResult, config: MapConfig) -> float:
    """Microseconds of an update by `scan`, which changes the pyramid."""
    return microseconds(partial(pyramid.update, scan.points, NONE, LASER, scan.planar, config))


def cells(pyramid: Pyramid) -> int:
    """Of all levels."""
    return sum(level.log_odds.size for level in pyramid.levels)


def memory(pyramid: Pyramid) -> int:
    """Bytes of all arrays of all levels."""
    arrays = (value for level in pyramid.levels for value in vars(level).values() if isinstance(value, np.ndarray))
    return sum(array.nbytes for array in arrays)


def mapped(results: list[StepResult], config: MapConfig) -> Pyramid:
    """A map of another shape, by the scans that a run wrote into its own."""
    pyramid = Pyramid(config)
    for result in results:
        if result.map_updated:
            pyramid.update(result.points, NONE, LASER, result.planar, config)
    return pyramid


def scaling(seed: int = 1) -> str:
    """How the match and the update of one scan grow with beams, levels and the size of the map: tables."""
    options = SceneOptions(duration=SCALING_S, seed=seed)
    by_beams = [_row(f"{n}", _drive(replace(options, beams=n)), MapConfig()) for n in BEAMS]
    drive = _drive(options)
    by_levels = [_row(f"{n}", drive, MapConfig(levels=n)) for n in LEVELS]
    by_size = [_row(f"{n} x {n}", drive, MapConfig(size=n)) for n in SIZES]
    parts = (("beams", by_beams), ("levels", by_levels), ("cells of the finest level", by_size))
    return "\n".join(table((name, "match, us", "update, us", "map, MB"), rows) for name, rows in parts)


def _drive(options: SceneOptions) -> list[StepResult]:
    slam = HectorSlam(SlamConfig())
    return [result for each in measurements(options) if (result := slam.step(each)) is not None]


def _row(name: str, results: list[StepResult], config: MapConfig) -> tuple[str, ...]:
    pyramid = mapped(results, config)
    matched = match(pyramid, results[-1], MatcherConfig())
    return name, f"{matched:.0f}", f"{update(pyramid, results[-1], config):.0f}", f"{memory(pyramid) / 1e6:.1f}"


class Looks(NamedTuple):
    """parts: name, value and unit of each part of a step, as of the best look. runs: by recording, one a look."""

    parts: list[Part]
    runs: dict[str, list[Run]]


def looks(seconds: float = DRIVE_S, seed: int = 1, only_pose: bool = False) -> Looks:
    """The rooms and the recordings that come with the project, again and again."""
    recordings: dict[str, Load] = {ROOMS: partial(_rooms, SceneOptions(duration=seconds, seed=seed), only_pose)}
    recordings |= {each.name: partial(_recorded, each) for each in present(DEMOS)}
    parts: list[list[Part]] = []
    runs: dict[str, list[Run]] = {name: [] for name in recordings}
    with ProcessPoolExecutor(1, get_context("spawn"), max_tasks_per_child=1) as pool:
        for name, load in list(recordings.items()) * ROUNDS:
            close, whole = pool.submit(_look, load, name == ROOMS).result()
            parts += close
            runs[name] += whole
    return Looks([_best(part) for part in zip(*parts, strict=True)], runs)


def _look(load: Load, closely: bool) -> tuple[list[list[Part]], list[Run]]:
    """The parts, if it is looked at closely, and the runs; in a process of its own, as in the application."""
    load_everything()
    recording, parts, runs = load(), [], []
    for k in range(LOOKS):
        time.sleep(PAUSE_S if k else 0.0)
        for _ in range(2):  # a processor that had nothing to do is slow at first, so the first run does not count
            slam = HectorSlam(SlamConfig(), clock=time.perf_counter_ns)
            done = run(slam, recording)
        runs.append(done)
        if closely:
            parts.append([*steps(runs[-1]), *kernels(slam, runs[-1].last)])
    return parts, runs


def _rooms(options: SceneOptions, only_pose: bool) -> list[Measurement]:
    return list(measurements(options, only_pose))


def _recorded(recording: Recording) -> list[Measurement]:
    return list(in_order(open_source(str(recording.path), recording.options).items()))


def rates(runs: list[Run]) -> tuple[float, float, float]:
    """Scans a second of whole steps: the median run, the best, and every measurement as fast as it ever was."""
    scans, spent = len(runs[0].durations), np.array([each.spent for each in runs])
    whole = spent.sum(axis=1)
    median, best, undisturbed = (
        scans * 1e9 / float(time_ns) for time_ns in (np.median(whole), whole.min(), spent.min(axis=0).sum())
    )
    return median, best, undisturbed


def _best(looks: tuple[Part, ...]) -> Part:
    """Others who use the machine only make it slower."""
    name, _, unit = looks[0]
    values = [value for _, value, _ in looks]
    return name, max(values) if unit == "scans/s" else min(values), unit


def tables(seen: Looks) -> tuple[str, str]:
    """Parts and whole steps as Markdown."""
    parts = table(("part", "cost"), ((name, f"{value:.1f} {unit}") for name, value, unit in seen.parts))
    head = ("whole steps, scans/s", "scans", "median", "best", "undisturbed")
    rows = (
        (name, f"{len(runs[0].durations)}", *(f"{rate:.0f}" for rate in rates(runs)))
        for name, runs in seen.runs.items()
    )
    return parts, table(head, rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=DRIVE_S)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only-pose", action="store_true")
    args = parser.parse_args()
    load_everything()
    print(*tables(looks(args.seconds, args.seed, args.only_pose)), scaling(args.seed), sep="\n")


if __name__ == "__main__":
    main()
