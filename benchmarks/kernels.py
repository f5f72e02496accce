"""What the parts of a step cost, in process, on a simulated run through rooms of 30 x 20 m; and how that grows.

    python -m benchmarks.kernels [--seconds 20] [--seed 1] [--only-pose]

A beam evaluation is one endpoint's share of eqs. (11) and (13): place it, interpolate, add up. It is measured on
every beam sixteen times over, so that the call itself hardly counts. --only-pose leaves inertial data out.
"""

import argparse
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from app.simulation import SceneOptions, Simulation
from app.sources import Item, open_source
from app.warmup import warm_up
from benchmarks.cases import DEMOS, present
from benchmarks.tables import table
from slam_core.config import MapConfig, MatcherConfig, SlamConfig
from slam_core.matcher import coarse_to_fine, normal_equations
from slam_core.measurements import Height, Imu, LaserScan, Measurement, TruthPose
from slam_core.pyramid import Pyramid
from slam_core.results import Durations, StepResult
from slam_core.sequence import Sequencer
from slam_core.slam import HectorSlam
from slam_core.surfaces import Beams

REPEATS = 200
TILES = 16
LOOKS, PAUSE_S = 10, 4.0  # a shared machine is slower for seconds on end
BEAMS, LEVELS, SIZES = (271, 541, 1081, 2161), (1, 2, 3, 4, 5), (512, 1024, 2048, 4096)
SCALING_S = 8.0  # of the drive: what it has seen by then is larger than a scan's reach
OFF = np.array([0.03, -0.02, 0.01])  # of the start estimate
LASER, NONE = np.zeros(2), np.empty((0, 2), np.float32)


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


def run(slam: HectorSlam, recording: list[Measurement]) -> tuple[list[Durations], list[bool], StepResult, float]:
    """Of every scan its durations and whether it was written into the map; the last result; seconds for all.

    As in the application, no other result is kept.
    """
    durations, mapped, last = [], [], None
    begin = time.perf_counter()
    for measurement in recording:
        result = slam.step(measurement)
        if result is not None:
            durations.append(result.durations)
            mapped.append(result.map_updated)
            last = result
    took = time.perf_counter() - begin
    assert last is not None
    return durations, mapped, last, took


def steps(durations: list[Durations], mapped: list[bool], took: float) -> Iterator[tuple[str, float, str]]:
    """Medians of the parts of a step, and scans a second over all."""
    for part in ("stabilise", "filter", "match"):
        yield part, float(np.median([getattr(each, part) for each in durations])) * 1e-3, "us"
    updates = [each.update for each, written in zip(durations, mapped, strict=True) if written]
    yield f"map update, {len(updates)} of {len(durations)} scans", float(np.median(updates)) * 1e-3, "us"
    alone = [each.match + each.update for each in durations]
    yield "match and map alone, as others are measured", 1e9 / float(np.mean(alone)), "scans/s"
    yield "whole step, inertial data and updates included", len(durations) / took, "scans/s"


def kernels(slam: HectorSlam, scan: StepResult) -> Iterator[tuple[str, float, str]]:
    """One scan matched and written again and again, on a copy of the map."""
    pyramid = slam.pyramid.copy()
    many, level = np.tile(scan.points, (TILES, 1)), pyramid.levels[0]
    for name, beams in (("plain", Beams.plain(many)), ("across surfaces", Beams.with_surfaces(many))):
        evaluation = microseconds(partial(normal_equations, level, beams, scan.planar))
        yield f"beam evaluation, {name}", evaluation * 1e3 / len(many), "ns"
    match, update = costs(pyramid, scan, slam.config.map)
    yield f"match of one scan from 4 cm off, {len(scan.points)} beams", match, "us"
    yield f"update of {len(pyramid.levels)} levels by one scan", update, "us"
    yield "memory of a cell, all in", memory(pyramid) / cells(pyramid), "bytes"


def costs(pyramid: Pyramid, scan: StepResult, config: MapConfig) -> tuple[float, float]:
    """Microseconds of a match of `scan` and of an update by it, which changes the pyramid."""
    start, matcher = scan.planar + OFF, MatcherConfig()
    match = microseconds(lambda: coarse_to_fine(pyramid, scan.points, start, matcher))
    return match, microseconds(lambda: pyramid.update(scan.points, NONE, LASER, scan.planar, config))


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
    match, update = costs(pyramid, results[-1], config)
    return name, f"{match:.0f}", f"{update:.0f}", f"{memory(pyramid) / 1e6:.1f}"


def parts(seconds: float = 20.0, seed: int = 1, only_pose: bool = False) -> list[tuple[str, float, str]]:
    """Name, value and unit of everything but the scaling."""
    recording = list(measurements(SceneOptions(duration=seconds, seed=seed), only_pose))
    sources = {each.name: open_source(str(each.path), each.options) for each in present(DEMOS)}
    demos = {name: list(in_order(source.items())) for name, source in sources.items()}
    looks = []
    for k in range(LOOKS):
        time.sleep(PAUSE_S if k else 0.0)
        slam = HectorSlam(SlamConfig(), time.perf_counter_ns)
        durations, mapped, last, took = run(slam, recording)
        looks.append([*steps(durations, mapped, took), *kernels(slam, last), *demo_steps(demos)])
    scans = sum(isinstance(measurement, LaserScan) for measurement in recording)
    return [("scans", scans, ""), *map(_best, zip(*looks, strict=True))]


def demo_steps(demos: dict[str, list[Measurement]]) -> Iterator[tuple[str, float, str]]:
    """Scans a second of the recordings that come with the project, with all that they hold."""
    for name, recording in demos.items():
        durations, _, _, took = run(HectorSlam(SlamConfig(), time.perf_counter_ns), recording)
        yield f"whole step, {name}", len(durations) / took, "scans/s"


def _best(looks: tuple[tuple[str, float, str], ...]) -> tuple[str, float, str]:
    """Others who use the machine only make it slower."""
    name, _, unit = looks[0]
    values = [value for _, value, _ in looks]
    return name, max(values) if unit == "scans/s" else min(values), unit


def parts_table() -> str:
    """`parts` as Markdown."""
    return table(("part", "cost"), ((name, f"{shown(value)} {unit}".rstrip()) for name, value, unit in parts()))


def shown(value: float) -> str:
    """With one decimal, unless it is a count."""
    return str(value) if isinstance(value, int) else f"{value:.1f}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only-pose", action="store_true")
    args = parser.parse_args()
    warm_up()
    for name, value, unit in parts(args.seconds, args.seed, args.only_pose):
        print(f"{name:50} {shown(value):>9} {unit}")
    print(scaling(args.seed))


if __name__ == "__main__":
    main()
