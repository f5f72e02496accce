"""How old a scan is when its pose is published, and when the robot is drawn there: a live stream, one browser.

    python -m benchmarks.latency [RECORDING] [--seconds 40]

A recording (the arena's, 40 Hz, unless told otherwise) is replayed on a real Foxglove server in a process of its
own. Another one maps it, and serves the page to a Chromium, which draws in software. Times count from when the
source hands out a scan: until its pose is handed to what publishes results (`--publish`), which has to wait for
inertial data that covers the sweep; until the snapshot for the page has it; and until a pixel can be read of a
drawing with the robot at that pose. Not every scan is drawn. Both clocks are those of one machine.
"""

import argparse
import os
import time
from pathlib import Path

import numpy as np
from playwright.sync_api import Page, sync_playwright

from benchmarks.live import TimedSource
from benchmarks.screenshots import SIZE
from benchmarks.seek import READY
from benchmarks.tables import table
from hectorscope.cli.opening import demo_bag
from hectorscope.inputs import SourceOptions
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.run.warmup import load_everything
from hectorscope.session.engine import Engine
from hectorscope.session.snapshot import Snapshot
from hectorscope.sources.bag import open_bag
from hectorscope.web.server import PageServer
from slam_core.results import StepResult
from tests.conftest import FLAGS, chromium_path
from tests.live.conftest import started

PATIENCE_MS = 120_000
GOALS_MS = {"pose published": (10, 30), "pose in the snapshot": (10, 30), "robot drawn": (150, None)}
SAME_M = 1e-4  # the page has single precision
PAGE_READY = "window.hectorscope?.drawing && window.__viserMutable?.nodeRefFromName?.['/robot']"
MAP_READY = READY.partition(" && ")[0]
# Notes the robot's place and the time, in milliseconds since 1970, of each drawing in which it has moved.
WATCH = """() => {
  const drawn = (window.drawnPoses = []);
  let before = "";
  window.hectorscope.drawing.push((_page, scene, _camera, renderer) => {
    const { x, y } = window.__viserMutable.nodeRefFromName["/robot"].position;
    if (`${x} ${y}` === before) return;
    before = `${x} ${y}`;
    const after = scene.onAfterRender;
    scene.onAfterRender = (...all) => {
      after.apply(scene, all);
      const context = renderer.getContext();
      context.readPixels(0, 0, 1, 1, context.RGBA, context.UNSIGNED_BYTE, new Uint8Array(4));
      scene.onAfterRender = after;
      drawn.push([x, y, performance.timeOrigin + performance.now()]);
    };
  });
}"""


class Watched:
    """An engine that maps a stream, and when each scan came, was published and shown: monotonic ns by stamp."""

    def __init__(self, uri: str) -> None:
        self.source = TimedSource(uri)
        self.published: dict[int, int] = {}
        self.shown: dict[int, int] = {}
        self.places: dict[int, tuple[float, float]] = {}
        self.engine = Engine(self.source, Settings())
        self.engine.observe(self._publish)
        put = self.engine.mailbox.put

        def noted(now: Snapshot) -> None:
            put(now)
            if now.result is not None:
                self.shown.setdefault(now.playback.time_ns, time.monotonic_ns())

        self.engine.mailbox.put = noted  # type: ignore[method-assign, assignment]

    def _publish(self, pipeline: Pipeline, result: StepResult) -> None:
        x, y, _ = result.T_map_base.translation.tolist()
        self.published[pipeline.time_ns] = time.monotonic_ns()
        self.places[pipeline.time_ns] = x, y

    def since_arrival(self, times: dict[int, int], begun_ns: int) -> list[float]:
        """Milliseconds from when each scan came behind `begun_ns`."""
        arrived, known = self.source.arrived, times.copy()  # the run goes on
        return [(at - arrived[stamp]) / 1e6 for stamp, at in known.items() if arrived.get(stamp, 0) > begun_ns]


def drawn(watched: Watched, rows: list[list[float]], begun_ns: int) -> list[float]:
    """Milliseconds from when a scan came to when the robot was drawn at its pose, of each drawing."""
    stamps = [stamp for stamp in watched.places if watched.source.arrived.get(stamp, 0) > begun_ns]
    places = np.array([watched.places[stamp] for stamp in stamps])
    to_wall_ns = time.time_ns() - time.monotonic_ns()
    taken = []
    for x, y, at_ms in rows:
        away = np.hypot(*(places - (x, y)).T)
        nearest = int(away.argmin())
        late_ms = at_ms - (watched.source.arrived[stamps[nearest]] + to_wall_ns) / 1e6
        if away[nearest] < SAME_M and late_ms > 0.0:
            taken.append(late_ms)
    return taken


def measured(recording: Path, seconds: float) -> tuple[dict[str, list[float]], int]:
    """Milliseconds by name, and the scans that were dropped."""
    topics = sorted(open_bag(recording, SourceOptions()).roles.topics())
    robot = started(recording, "--topics", *topics)
    try:
        watched = Watched(robot.uri)
        server = PageServer(watched.engine, port=0)
        server.start()
        with sync_playwright() as playwright:
            page = playwright.chromium.launch(executable_path=chromium_path(), args=FLAGS).new_page(viewport=SIZE)
            page.goto(f"{server.url}?fixedDpr=0.3")
            page.wait_for_function(PAGE_READY, timeout=PATIENCE_MS)
            watched.engine.start()  # the robot sends from now on
            page.wait_for_function(MAP_READY, timeout=PATIENCE_MS)
            figures = _watch(watched, page, seconds)
        watched.engine.stop()
        server.stop()
        return figures, watched.engine._session.report.dropped
    finally:
        robot.kill()


def _watch(watched: Watched, page: Page, seconds: float) -> dict[str, list[float]]:
    page.evaluate(WATCH)
    begun_ns = time.monotonic_ns()
    page.wait_for_timeout(1e3 * seconds)
    rows = page.evaluate("window.drawnPoses")
    return {
        "pose published": watched.since_arrival(watched.published, begun_ns),
        "pose in the snapshot": watched.since_arrival(watched.shown, begun_ns),
        "robot drawn": drawn(watched, rows, begun_ns),
    }


def cells(name: str, taken: list[float]) -> tuple[str, ...]:
    """Of the table."""
    half, most = GOALS_MS[name]
    p50, p99 = np.percentile(taken, [50, 99])
    goal = f"{half} ms" if most is None else f"{half} / {most} ms"
    return name, f"{p50:.1f} ms", f"{p99:.1f} ms", f"{max(taken):.1f} ms", str(len(taken)), goal


def main() -> None:
    """Print the table, and how busy the machine was."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("recording", type=Path, nargs="?")
    parser.add_argument("--seconds", type=float, default=40.0)
    given = parser.parse_args()
    load_everything()
    before = os.getloadavg()[0]
    figures, dropped = measured(Path(given.recording or demo_bag("arena")).resolve(), given.seconds)
    head = ("from a scan to", "median", "99 %", "longest", "measured", "goal")
    print(table(head, [cells(name, taken) for name, taken in figures.items()]))
    after = os.getloadavg()[0]
    print(f"scans dropped {dropped}; load {before:.1f} before and {after:.1f} behind, {os.cpu_count()} cores")


if __name__ == "__main__":
    main()
