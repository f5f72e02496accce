"""Pictures of what a teacher uses: lessons, and the robot that is driven.

python -m benchmarks.teaching_pictures           on a desk and a phone, in both themes, into build/screenshots
python -m benchmarks.teaching_pictures --docs    those of docs/teaching.md, into docs/images
"""

import argparse
import io
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from PIL import Image
from playwright.sync_api import Browser, Page, sync_playwright

from benchmarks.screenshots import LOOK_MS, NOTICE, SIZES
from hectorscope.cli.opening import demos
from hectorscope.inputs import SourceOptions
from hectorscope.run.settings import Settings
from hectorscope.run.warmup import load_everything
from hectorscope.session.commands import Configure
from hectorscope.session.engine import Engine
from hectorscope.session.library import Library
from hectorscope.simulation.drive_source import DriveSource
from hectorscope.sources import open_source
from hectorscope.steering import PutBox, Request, SetFault, Steer
from hectorscope.web.server import PageServer
from slam_core.config import SlamConfig, with_values
from tests.conftest import FLAGS, ROOT, chromium_path
from tests.engines import until

LOADED = "!!window.hectorscope?.lessons && !!document.querySelector('[data-hs-facts]')"
DRAWN = "!!hectorscope.levels().places.length && !!__viserMutable.nodeRefFromName['/robot']"
PATIENCE_MS, PATIENCE_S = 180_000, 180.0
COLOURS = 64  # of a picture in the documents
LESSON, PYRAMID = "2-between-cells", "4-pyramid"
AT_REST_S, DRIVEN_S = 3.0, 14.0
# Pictures of the driven robot: settings of the run, requests to the robot, and whether it is seen from above.
DRIVES: tuple[tuple[str, dict[str, bool], tuple[Request, ...], bool], ...] = (
    ("drive", {}, (SetFault("gyro_bias", 0.5), PutBox(0, (3.0, 1.5))), False),
    ("stabilised", {}, (SetFault("sway", 15.0),), True),
    ("smeared", {"scan.stabilise": False}, (SetFault("sway", 15.0),), True),
)


@contextmanager
def served(engine: Engine, **options: Any) -> Iterator[PageServer]:
    """The page of an engine."""
    server = PageServer(engine, port=0, **options)
    server.start()
    engine.start()
    try:
        yield server
    finally:
        engine.stop()
        server.stop()


def opened(browser: Browser, url: str, size: str, theme: str) -> Page:
    """A page of a new person."""
    page = browser.new_context(viewport=SIZES[size]).new_page()
    page.add_init_script(f'localStorage.setItem(\'hectorscope\', \'{{"theme": "{theme}", "plots": "off"}}\')')
    page.goto(f"{url}?fixedDpr=1")
    page.wait_for_function(LOADED, timeout=PATIENCE_MS)
    return page


def finished(page: Page) -> bytes:
    """The picture, once the map is drawn and notices are closed."""
    page.wait_for_function(DRAWN, timeout=PATIENCE_MS)
    page.wait_for_timeout(LOOK_MS)
    for notice in page.locator(NOTICE).all():
        notice.click()
    page.wait_for_timeout(2 * LOOK_MS)
    picture = page.screenshot()
    page.context.close()
    return picture


def lesson(browser: Browser, server: PageServer, size: str, theme: str) -> bytes:
    """One with formulas."""
    page = opened(browser, server.url, size, theme)
    page.evaluate(f"hectorscope.lessons.toggle().then(() => hectorscope.lessons.open('{LESSON}'))")
    return finished(page)


def without_pyramid(browser: Browser, engine: Engine, server: PageServer, size: str, theme: str) -> bytes:
    """The lesson of the pyramid once its task is done: the match has lost the walk."""
    page = opened(browser, server.url, size, theme)
    page.evaluate(f"hectorscope.lessons.toggle().then(() => hectorscope.lessons.open('{PYRAMID}'))")
    page.wait_for_function(DRAWN, timeout=PATIENCE_MS)
    until(engine, lambda now: now.playback.state == "paused" and "handheld" in now.source, PATIENCE_S)
    engine.send(Configure("map.levels", 1))
    page.wait_for_selector(".hs-task[data-done]", state="attached", timeout=PATIENCE_MS)
    return finished(page)


def driven(browser: Browser, server: PageServer, size: str, theme: str, *, above: bool) -> bytes:
    """The card of the robot, with its sliders."""
    page = opened(browser, server.url, size, theme)
    page.wait_for_function(DRAWN, timeout=PATIENCE_MS)
    page.evaluate("document.querySelector('.hs-drive details').open = true")
    if above:
        page.evaluate("hectorscope.own.set('layout', 'one'); hectorscope.camera('top')")
    return finished(page)


def drive_a_little(engine: Engine, source: DriveSource, *requests: Request) -> None:
    """A curve, so that there is a map to see."""
    for request in requests:
        source.drive(request)

    def elapsed(seconds: float) -> None:
        until(engine, lambda now: now.playback.time_ns - now.playback.start_ns > seconds * 1e9, PATIENCE_S)

    elapsed(AT_REST_S)
    now = AT_REST_S
    while now < DRIVEN_S:
        source.drive(Steer(0.8, 0.15))
        now += 0.2
        elapsed(now)


def wanted(docs: bool) -> list[tuple[str, str]]:
    """Sizes and themes."""
    return [("desk", "dark")] if docs else [(s, t) for s in ("desk", "phone") for t in ("dark", "light")]


def take(browser: Browser, folder: Path, docs: bool) -> Iterator[Path]:
    """One picture after the other."""

    def kept(name: str, size: str, theme: str, picture: bytes) -> Path:
        target = folder / (f"{name}.png" if docs else f"{name}-{size}-{theme}.png")
        small = Image.open(io.BytesIO(picture)).convert("RGB")
        (small.quantize(COLOURS) if docs else small).save(target, optimize=True)
        return target

    engine = Engine(None)
    engine.offer(Library(lambda path, _: open_source(str(path), SourceOptions()), demos=demos()))
    with served(engine) as server:
        for size, theme in wanted(docs):
            yield kept("lesson", size, theme, lesson(browser, server, size, theme))
            yield kept("pyramid", size, theme, without_pyramid(browser, engine, server, size, theme))
    for name, settings, requests, above in DRIVES:
        source = DriveSource("rooms")
        engine = Engine(source, Settings(with_values(SlamConfig(), settings)))
        with served(engine) as server:
            drive_a_little(engine, source, *requests)
            for size, theme in wanted(docs):
                yield kept(name, size, theme, driven(browser, server, size, theme, above=above))


def main() -> None:
    """Take them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--docs", action="store_true", help="the pictures of the documents")
    chosen = parser.parse_args()
    folder = ROOT / ("docs/images" if chosen.docs else "build/screenshots")
    folder.mkdir(parents=True, exist_ok=True)
    load_everything()
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium_path(), args=FLAGS)
        for path in take(browser, folder, chosen.docs):
            print(path, flush=True)
        browser.close()


if __name__ == "__main__":
    main()
