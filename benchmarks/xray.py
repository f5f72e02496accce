"""How long the laboratories of the X-ray take on a scan of 1081 beams: medians, and the slowest.

    python -m benchmarks.xray [--seconds 10] [--repeats 50] [--browser]

A drag is measured from a new start to the picture that a browser is sent, on the thread of the page that works for
browsers, one start after another. --browser: how often the card of a real Chromium follows instead, whose own
drawing in software is counted.
"""

import argparse
import queue
import time
from collections.abc import Callable
from functools import partial

import numpy as np

from benchmarks import xray_drag
from benchmarks.tables import table
from hectorscope.panels._xray_shown import Shown
from hectorscope.panels._xray_wanted import Wanted
from hectorscope.panels._xray_worker import Subject, Worker
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.run.warmup import load_everything
from hectorscope.run.xray.covariances import Cloud, fusion
from hectorscope.run.xray.landscape import Around, Basin, landscape
from hectorscope.run.xray.match_problem import MatchProblem, problem_of
from hectorscope.session.rework import Rework
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.config import SlamConfig
from slam_core.measurements import LaserScan
from slam_core.results import StepResult

BEAMS = 1081
PATIENCE_S = 30.0


def scanned(seconds: float) -> tuple[Rework, StepResult, Settings]:
    """The last scan of a drive through rooms, and the run before it."""
    settings, rework = Settings(SlamConfig()), None
    pipeline = Pipeline(settings)
    for item in Simulation("rooms", SceneOptions(duration=seconds, scan_rate=10.0, beams=BEAMS)).items():
        for measurement in pipeline.admit(item):
            if isinstance(measurement, LaserScan):
                rework = Rework(pipeline, measurement.stamp_ns, None)
            pipeline.step(measurement)
    assert rework is not None and pipeline.result is not None
    return rework, pipeline.result, settings


def spent(call: Callable[[], object], repeats: int) -> tuple[float, float]:
    """Median and longest of a call, milliseconds."""
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        call()
        times.append(1e3 * (time.perf_counter() - begin))
    return float(np.median(times)), max(times)


def drags(rework: Rework, result: StepResult, settings: Settings, repeats: int) -> tuple[float, float]:
    """Median and longest time from another start to what is shown of it, milliseconds."""
    shown: queue.Queue[Shown] = queue.Queue()
    worker = Worker(lambda _, found: shown.put(found))
    worker.look_at(Subject(rework, result, settings.start, settings))
    worker.want(1, Wanted(lab="landscape"))
    start = shown.get(timeout=PATIENCE_S).handle
    assert start is not None
    steps = iter(np.random.default_rng(1).uniform(-0.5, 0.5, (repeats, 3)))

    def drag() -> None:
        worker.start_at(1, start + next(steps))
        shown.get(timeout=PATIENCE_S)

    found = spent(drag, repeats)
    worker.leave(1)
    return found


def rows(problem: MatchProblem, repeats: int) -> list[tuple[str, float, float]]:
    """Each part with its median and its longest time."""
    parts: dict[str, Callable[[], object]] = {
        f"landscape of level {level}, 61 x 61 poses x {len(problem.points)} beams": partial(
            landscape, problem, level, Around("xy", 1.0)
        )
        for level in range(len(problem.grids))
    }
    parts["all iterations of the reference"] = lambda: problem.iterations(problem.start)
    parts["covariances and their fusion"] = lambda: fusion(problem, 0.3)
    found = [(name, *spent(call, repeats)) for name, call in parts.items()]
    found.append(("basin, 3721 starts", *spent(lambda: _whole(Basin(problem, Around("xy", 1.0))), 3)))
    found.append(("cloud, 400 matches", *spent(lambda: _whole(Cloud(problem, 0.02)), 3)))
    return found


def _whole(work: Basin | Cloud) -> None:
    while not work.whole:
        work.try_next()


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--repeats", type=int, default=50)
    parser.add_argument("--browser", action="store_true", help="how often the card of a browser follows a drag")
    chosen = parser.parse_args()
    load_everything()
    if chosen.browser:
        print(xray_drag.measure(chosen.seconds, BEAMS))
        return
    rework, result, settings = scanned(chosen.seconds)
    problem = problem_of(rework.before(settings), result, settings.start)
    assert problem is not None
    found = rows(problem, chosen.repeats)
    found.append(("a dragged start, to its picture", *drags(rework, result, settings, chosen.repeats)))
    cells = [[name, f"{median:.1f}", f"{longest:.1f}"] for name, median, longest in found]
    print(table(["part", "median, ms", "longest, ms"], cells))


if __name__ == "__main__":
    main()
