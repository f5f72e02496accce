"""How long a seek takes behind one pass, at random times: to the published snapshot, and to the drawn map.

    python -m benchmarks.seek [BAG] [--seeks 100] [--checkpoints 512] [--browser]

Without a recording, the scenes of the demo are taken. BAG: what `hectorscope` takes. The pass is the one ahead of
what is shown; the run rests meanwhile. --browser: from the release of the timeline, on a page at rest, until the
pixels of the new map are there, in a real Chromium, whose own drawing in software is counted.
"""

import argparse
import random
import statistics
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

from benchmarks.tables import table
from hectorscope.checks.sensor_check import CheckedSource
from hectorscope.inputs import SourceOptions
from hectorscope.run.checkpoints import BUDGET_MB
from hectorscope.run.warmup import load_everything
from hectorscope.session.commands import Command, Seek
from hectorscope.session.engine import Engine
from hectorscope.session.snapshot import Snapshot
from hectorscope.sources import open_source
from hectorscope.web.server import PageServer
from tests.conftest import FLAGS, chromium_path

DEMOS = (Path("demo_bags/arena.bag"), Path("demo_bags/littoral.mcap"))
LOOK_S = 0.001
QUIET_MS = 150
FAR_S = 2.0  # seconds of a recording: so far away the map is another one
CELLS = "/floor/map/level0/cells"
READY = f"window.__viserMutable?.nodeRefFromName?.['{CELLS}'] && window.hectorscope?.timeline?.state().end"
# Milliseconds from the release of the timeline at a time until a pixel can be read of the scene that has another
# picture of the finest level, and the run is there.
RELEASED = """(seconds) => new Promise((drawn) => {
  const { timeline, drawing } = window.hectorscope;
  const picture = () => {
    let found = null;
    const level = window.__viserMutable.nodeRefFromName['/floor/map/level0/cells'];
    level.traverse((part) => (found ??= part.material?.map));
    return found;
  };
  const [before, begun] = [picture(), performance.now()];
  const look = (_page, scene, _camera, renderer) => {
    const { at, state } = timeline.state();
    if (state === 'seeking' || Math.abs(at - seconds) > 0.2 || picture() === before) return;
    drawing.splice(drawing.indexOf(look), 1);
    const after = scene.onAfterRender;
    scene.onAfterRender = () => {
      const context = renderer.getContext();
      context.readPixels(0, 0, 1, 1, context.RGBA, context.UNSIGNED_BYTE, new Uint8Array(4));
      scene.onAfterRender = after;
      drawn(performance.now() - begun);
    };
  };
  drawing.push(look);
  timeline.seek(seconds);
})"""
# Once nothing was drawn for so many milliseconds.
RESTED = """(quiet) => new Promise((rested) => {
  const { drawing } = window.hectorscope;
  const wait = () => setTimeout(() => (drawing.splice(drawing.indexOf(draws), 1), rested()), quiet);
  let timer = wait();
  const draws = () => (clearTimeout(timer), (timer = wait()));
  drawing.push(draws);
})"""


def until_whole(engine: Engine) -> Snapshot:
    """The snapshot once the pass is at the end."""
    while not ((now := engine.mailbox.latest) and now.ahead.whole):
        time.sleep(LOOK_S)
    return now


def rest(engine: Engine, *commands: Command) -> Snapshot:
    """The snapshot once commands were obeyed and the engine rests."""
    for command in commands:
        engine.send(command)
    while True:
        now = engine.mailbox.latest
        if now and now.obeyed == engine.sent and now.playback.state in ("paused", "ended", "failed"):
            return now
        time.sleep(LOOK_S)


@contextmanager
def passed(path: Path, budget: int) -> Iterator[tuple[Engine, float]]:
    """An engine at rest whose pass is done, and the seconds that it took."""
    source = CheckedSource(partial(open_source, str(path)), SourceOptions())
    engine = Engine(source, autoplay=False, checkpoints=budget)
    begun = time.perf_counter()
    engine.start()
    try:
        until_whole(engine)
        yield engine, time.perf_counter() - begun
    finally:
        engine.stop()


def published(engine: Engine, seeks: int) -> list[float]:
    """Milliseconds of each seek, from the command to the snapshot."""
    playback, where, taken = until_whole(engine).playback, random.Random(1), []
    for _ in range(seeks):
        time_ns = where.randint(playback.start_ns, playback.end_ns or 0)
        begun = time.perf_counter()
        rest(engine, Seek(time_ns))
        taken.append(1e3 * (time.perf_counter() - begun))
    return taken


def drawn(engine: Engine, page: Page, seeks: int) -> list[float]:
    """Milliseconds of each, from the release of the timeline to the drawn map."""
    playback, where = until_whole(engine).playback, random.Random(1)
    taken: list[float] = []
    length, before = ((playback.end_ns or 0) - playback.start_ns) / 1e9, 0.0
    while len(taken) < seeks:
        seconds = where.uniform(FAR_S, length - 0.2)
        if abs(seconds - before) >= FAR_S:
            page.evaluate(RESTED, QUIET_MS)
            taken.append(float(page.evaluate(RELEASED, seconds)))
            before = seconds
    return taken


def measured(path: Path, options: argparse.Namespace, page: Page | None) -> list[str]:
    """A row of the table."""
    with passed(path, options.checkpoints) as (engine, took):
        if page is None:
            taken = published(engine, options.seeks)
        else:
            rest(engine, Seek(until_whole(engine).ahead.time_ns))  # else there is no map to be drawn
            server = PageServer(engine, port=0)
            server.start()
            page.goto(f"{server.url}?fixedDpr=0.3")
            page.wait_for_function(READY)
            taken = drawn(engine, page, options.seeks)
            server.stop()
    median, most = statistics.median(taken), max(taken)
    tenth = sorted(taken)[-max(1, len(taken) // 10)]
    return [path.name, f"{took:.1f} s", *(f"{each:.0f} ms" for each in (median, tenth, most))]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bags", nargs="*", type=Path, default=DEMOS)
    parser.add_argument("--seeks", type=int, default=100)
    parser.add_argument("--checkpoints", type=int, default=BUDGET_MB, help="MiB")
    parser.add_argument("--browser", action="store_true", help="to the drawn map in a browser")
    options = parser.parse_args()
    load_everything()
    if options.browser:
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=chromium_path(), args=FLAGS)
            rows = [measured(path, options, browser.new_page()) for path in options.bags]
            browser.close()
    else:
        rows = [measured(path, options, None) for path in options.bags]
    print(table(("recording", "one pass", "median seek", "slowest tenth", "longest seek"), rows))


if __name__ == "__main__":
    main()
