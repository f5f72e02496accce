"""What the parts of a step cost, in process: medians over the scans of a simulated run through rooms.

    python -m benchmarks.kernels [--seconds 20] [--seed 1] [--only-pose]

A beam evaluation is one endpoint's share of eqs. (11) and (13): place it, interpolate, add up. It is measured on
every beam sixteen times over, so that the call itself hardly counts. --only-pose leaves inertial data out.
"""

import argparse
import time
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from app.simulation import SceneOptions, Simulation
from app.warmup import warm_up
from slam_core.config import SlamConfig
from slam_core.matcher import coarse_to_fine, normal_equations
from slam_core.measurements import Height, Imu, LaserScan, Measurement, TruthPose
from slam_core.results import StepResult
from slam_core.sequence import Sequencer
from slam_core.slam import HectorSlam
from slam_core.surfaces import Beams

REPEATS = 200
TILES = 16


def microseconds(call: Callable[[], object], repeats: int = REPEATS) -> float:
    """Median duration of a call."""
    times = np.empty(repeats)
    for k in range(repeats):
        begin = time.perf_counter_ns()
        call()
        times[k] = time.perf_counter_ns() - begin
    return float(np.median(times)) * 1e-3


def measurements(seconds: float, seed: int, only_pose: bool) -> Iterator[Measurement]:
    """Scans and, unless left out, inertial data, in the order of a Sequencer."""
    sequencer = Sequencer()
    for item in Simulation("rooms", SceneOptions(duration=seconds, seed=seed)).items():
        if not isinstance(item, TruthPose) and not (only_pose and isinstance(item, Imu | Height)):
            yield from sequencer.push(item)
    yield from sequencer.flush()


def run(slam: HectorSlam, recording: list[Measurement]) -> tuple[list[StepResult], float]:
    """Every step's result, and the seconds that all of them took."""
    begin = time.perf_counter()
    results = [slam.step(measurement) for measurement in recording]
    took = time.perf_counter() - begin
    return [result for result in results if result is not None], took


def steps(results: list[StepResult], took: float) -> Iterator[tuple[str, float, str]]:
    """Medians of the parts of a step, and scans a second over all."""
    for part in ("stabilise", "filter", "match"):
        yield part, float(np.median([getattr(r.durations, part) for r in results])) * 1e-3, "us"
    updates = [r.durations.update for r in results if r.map_updated]
    yield f"map update, {len(updates)} of {len(results)} scans", float(np.median(updates)) * 1e-3, "us"
    yield "whole step, inertial data and updates included", len(results) / took, "scans/s"


def kernels(slam: HectorSlam, scan: StepResult) -> Iterator[tuple[str, float, str]]:
    """One scan matched and written again and again, on a copy of the map."""
    pyramid, config = slam.pyramid.copy(), slam.config
    start, points = scan.planar + np.array([0.03, -0.02, 0.01]), scan.points
    many, level = np.tile(points, (TILES, 1)), pyramid.levels[0]
    for name, beams in (("plain", Beams.plain(many)), ("across surfaces", Beams.with_surfaces(many))):
        evaluation = microseconds(partial(normal_equations, level, beams, scan.planar))
        yield f"beam evaluation, {name}", evaluation * 1e3 / len(many), "ns"
    match = microseconds(lambda: coarse_to_fine(pyramid, points, start, config.matcher))
    yield f"match of one scan from 4 cm off, {len(points)} beams", match, "us"
    none, laser = np.empty((0, 2), np.float32), np.zeros(2)
    update = microseconds(lambda: pyramid.update(points, none, laser, scan.planar, config.map))
    yield f"update of {len(pyramid.levels)} levels by one scan", update, "us"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only-pose", action="store_true")
    args = parser.parse_args()
    recording = list(measurements(args.seconds, args.seed, args.only_pose))
    warm_up()
    print(f"rooms, {args.seconds:.0f} s, {sum(isinstance(m, LaserScan) for m in recording)} scans")
    slam = HectorSlam(SlamConfig(), time.perf_counter_ns)
    results, took = run(slam, recording)
    for name, value, unit in (*steps(results, took), *kernels(slam, results[-1])):
        print(f"{name:50} {value:9.1f} {unit}")


if __name__ == "__main__":
    main()
