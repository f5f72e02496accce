"""A map of kilometres: memory, the longest step, pictures and files of it, and a robot that gets lost in it.

    python -m benchmarks.long_drive [--kilometres 10]

An L of 700 m, and a staircase of streets and corridors, each leg 500 m long: the box around it is half as wide
and half as high as the way is long. 1081 beams of 30 m at 20 Hz, 8 m/s, wheels; scans go through HectorSlam. Times
are of the processor, so that other programs do not count. `--lost` adds a robot that gets lost at the end, and one
that starts anywhere in the saved map.
"""

import argparse
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import islice
from typing import Any

import numpy as np

from benchmarks.streets import BEAMS, RANGE, RATE, Streets, drive, scan, streets
from benchmarks.tables import table
from hectorscope.run.map_images import map_images
from hectorscope.run.warmup import load_everything
from slam_core.config import SlamConfig
from slam_core.localization.prior_map import PriorMap, saved_levels
from slam_core.mapping.pyramid import megabytes
from slam_core.measurements import Float64s, LaserScan, Measurement
from slam_core.slam import HectorSlam

SLOW_MS = 20.0
LEG_M = 500.0
BLIND_S, FOUND_S = 30.0, 600.0


@dataclass(slots=True)
class Steps:
    """Milliseconds of each scan's step, and which moved the window."""

    ms: list[float] = field(default_factory=list)
    moved: list[bool] = field(default_factory=list)

    def add(self, slam: HectorSlam, measurements: list[Measurement]) -> None:
        """Take in some measurements as one step."""
        window, begin = slam.map.window, time.thread_time()
        for measurement in measurements:
            slam.add(measurement)
        self.ms.append(1e3 * (time.thread_time() - begin))
        self.moved.append(slam.map.window != window)

    def figures(self) -> dict[str, str]:
        """For people."""
        ms, moved = np.array(self.ms), np.array(self.moved)
        return {
            "steps": f"{len(ms)}",
            "median step": f"{np.median(ms):.2f} ms",
            "steps that move the window": f"{moved.sum()}, median {np.median([0.0, *ms[moved]]):.1f} ms",
            "longest step": f"{ms.max():.1f} ms",
            f"steps over {SLOW_MS:g} ms": f"{(ms > SLOW_MS).sum()}",
        }


def driven(world: Streets) -> tuple[HectorSlam, dict[str, str]]:
    """The whole way, and the figures of it."""
    slam, steps, pose = HectorSlam(SlamConfig()), Steps(), np.zeros(3)
    for odometry, seen, truth in drive(world):
        steps.add(slam, [odometry, seen])
        pose = truth
    slam.finish()
    row0, row1, column0, column1 = slam.map.bounds()
    dense = megabytes((row1 - row0) * (column1 - column0), len(slam.map.levels))
    error = float(np.hypot(*(slam.trajectory.positions[-1, :2] - pose[:2])))
    rows, columns = slam.map.levels[0].shape
    return slam, {
        "way": f"{world.length / 1e3:.2f} km",
        "memory of the map": f"{slam.map.nbytes / 1e6:.0f} MB",
        "of that, the window": f"{rows} x {columns} cells, {sum(x.nbytes for x in slam.map.levels) / 1e6:.0f} MB",
        "tiles": f"{len(slam.map.changed_since(0))}",
        "one dense box would take": f"{dense:.0f} MB",
        **steps.figures(),
        "position error at the end": f"{error:.2f} m",
    }


def followed(slam: HectorSlam) -> dict[str, str]:
    """What pictures, copies and files of the map cost."""
    images, drawing = _timed(lambda: map_images(slam.map))
    _, copying = _timed(slam.map.copy)
    levels, saving = _timed(lambda: saved_levels(slam.map))
    _, asking = _timed(lambda: slam.map.changed_since(slam.map.revision - 1))
    rows, columns = images[0].cells.shape
    size = sum(level.log_odds.nbytes + (0 if level.surfels is None else level.surfels.nbytes) for level in levels)
    return {
        "picture of the finest level": f"{columns} x {rows} pixels of {100 * images[0].resolution:g} cm",
        "pictures of all levels": f"{drawing:.0f} ms",
        "copy": f"{copying:.0f} ms",
        "which tiles changed": f"{asking:.2f} ms",
        "cells to be saved": f"{size / 1e6:.0f} MB in {len(levels)} parts, {saving:.0f} ms",
    }


def blinded(slam: HectorSlam, world: Streets, begin_ns: int) -> dict[str, str]:
    """A robot that sees a round room for BLIND_S, and stands where it was then: the search for it goes on."""
    steps, pose = Steps(), np.array([*world.corners[-1], 0.0])
    angle = np.linspace(-0.75 * np.pi, 0.75 * np.pi, BEAMS)
    round_room = (3.0 + np.cos(5.0 * angle)).astype(np.float32)
    rng, states, found = np.random.default_rng(3), set(), 0.0
    for k in range(int((BLIND_S + FOUND_S) * RATE)):
        stamp_ns = begin_ns + round(k * 1e9 / RATE)
        seen = scan(world, pose, stamp_ns, rng)
        if k < BLIND_S * RATE:
            seen = LaserScan(stamp_ns, round_room, seen.angle_min, seen.angle_increment, range_max=RANGE)
        window, begin = slam.map.window, time.thread_time()
        results = slam.add(seen)
        steps.ms.append(1e3 * (time.thread_time() - begin))
        steps.moved.append(slam.map.window != window)
        states |= {result.tracking for result in results}
        found = k / RATE - BLIND_S
        if found > 0.0 and results and results[-1].tracking in {"tracking", "recovered"}:
            break
    figures = {f"{name}, lost": value for name, value in steps.figures().items()}
    return {**figures, "found again after": f"{found:.1f} s" if found < FOUND_S - 1.0 else f"not in {FOUND_S:g} s"}


def started(slam: HectorSlam, world: Streets) -> dict[str, str]:
    """A robot that starts anywhere in the saved map, in the middle of a leg."""
    prior = PriorMap("the streets", saved_levels(slam.map))
    localised, loading = _timed(lambda: HectorSlam(SlamConfig(), prior))
    steps, rng, k = Steps(), np.random.default_rng(5), 0
    pose = np.array([*(0.4 * world.corners[-2] + 0.6 * world.corners[-1]), 0.5])
    found: Float64s | None = None
    while found is None and k < FOUND_S * RATE:
        window, begin = localised.map.window, time.thread_time()
        results = localised.add(scan(world, pose, round(k * 1e9 / RATE), rng))
        steps.ms.append(1e3 * (time.thread_time() - begin))
        steps.moved.append(localised.map.window != window)
        found, k = (results[0].planar if results else None), k + 1
    figures = {f"{name}, at the start": value for name, value in steps.figures().items()}
    where = "not found" if found is None else f"{k / RATE:.1f} s, {np.hypot(*(found - pose)[:2]):.2f} m off"
    return {"loading the saved map": f"{loading:.0f} ms", **figures, "found at the start after": where}


def _timed(call: Callable[[], Any]) -> tuple[Any, float]:
    begin = time.thread_time()
    return call(), 1e3 * (time.thread_time() - begin)


def main() -> None:
    """Print the figures as they come."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kilometres", type=float, default=10.0)
    parser.add_argument("--lost", action="store_true", help="also get lost, and start anywhere in the saved map")
    arguments = parser.parse_args()
    load_everything()
    list(islice(drive(streets([20.0])), 3))
    for legs in ([350.0, 350.0], [LEG_M] * round(1e3 * arguments.kilometres / LEG_M)):
        world = streets(legs)
        slam, figures = driven(world)
        for part in _parts(slam, world, figures, lost=arguments.lost):
            print(table(("", ""), part.items()), flush=True)


def _parts(slam: HectorSlam, world: Streets, figures: dict[str, str], *, lost: bool) -> Iterator[dict[str, str]]:
    yield figures
    yield followed(slam)
    if lost:
        yield started(slam, world)
        yield blinded(slam, world, int(slam.trajectory.stamps_ns[-1]) + round(1e9 / RATE))


if __name__ == "__main__":
    main()
