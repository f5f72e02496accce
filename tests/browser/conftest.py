"""A real Chromium in front of a real page, without a window and with software graphics."""

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import pytest
from playwright.sync_api import Browser, Page, ViewportSize, expect, sync_playwright

from hectorscope.inputs import Item, Source, SourceOptions
from hectorscope.run.warmup import load_everything
from hectorscope.session.commands import Seek
from hectorscope.session.engine import Engine
from hectorscope.session.library import Library
from hectorscope.simulation import SceneOptions, SimulateOptions, Simulation, simulate
from hectorscope.sources import open_source
from hectorscope.web.server import PageServer
from tests import panels
from tests.conftest import FLAGS
from tests.engines import START, running, until
from tests.page import StillEngine, room_snapshot
from tests.sources import MemoryRecording

SIZE: ViewportSize = {"width": 1000, "height": 640}
KEPT = "localStorage.getItem('hectorscope') ?? localStorage.setItem('hectorscope', %s)"
# The map is there and was drawn.
READY = (
    "!!window.__viserMutable?.nodeRefFromName?.['/floor/map/level0']"
    " && !!window.hectorscope?.levels().places.length"
)
LISTED = "!!document.querySelector('[data-hs-library]') && !!window.hectorscope?.recordings"
UPLOADS = 8 * 2**20  # bytes that the server with recordings takes
PATIENCE = 60_000  # milliseconds: software graphics on a busy machine

expect.set_options(timeout=PATIENCE)

# Everything that this browser chose, and where the camera was, as of a page that has just been opened.
KEEP = """() => {
  window.hectorscope.own.set('theme', 'dark');
  window.begun = [JSON.parse(localStorage.getItem('hectorscope')), window.hectorscope.cameraNow().pose];
}"""
AS_OPENED = """(choices) => {
  const { own, camera } = window.hectorscope, [chosen, pose] = window.begun;
  document.activeElement?.blur();
  for (const [key, value] of Object.entries({ ...chosen, camera: null, ...choices })) own.set(key, value);
  document.querySelector('canvas[data-engine]').dispatchEvent(new WheelEvent('wheel'));
  camera('free');
  document.querySelector('canvas[data-engine]').dispatchEvent(new WheelEvent('wheel'));
  window.__viserMutable.cameraControl.setLookAt(...pose, false);
  camera((choices.layout ?? chosen.layout) === 'side' ? 'top' : 'fit');
}"""
BEGUN = """(() => {
  const at = window.__viserMutable.nodeRefFromName['/robot']?.position;
  return !!at && Math.hypot(at.x, at.y) < 1e-3 && window.hectorscope.levels().places.length === 3;
})()"""

# Some 25 frames a second. Software graphics that draw sixty take more than one processor, even of a page at rest.
FEWER_FRAMES = """(() => {
  const frame = window.requestAnimationFrame.bind(window), waiting = new Set();
  window.requestAnimationFrame = (draw) => {
    const id = window.setTimeout(() => frame((time) => waiting.delete(id) && draw(time)), 33);
    waiting.add(id);
    return id;
  };
  window.cancelAnimationFrame = (id) => waiting.delete(id) && window.clearTimeout(id);
})()"""

Open = Callable[..., Page]


@pytest.fixture(scope="module")
def browser(chromium: str) -> Iterator[Browser]:
    """One Chromium for a file of tests; each page gets a profile of its own.

    Not for the whole session: Playwright keeps an event loop running, beside which no other test could run one.
    """
    with sync_playwright() as playwright:
        made = playwright.chromium.launch(executable_path=chromium, args=FLAGS)
        yield made
        made.close()


def with_query(url: str) -> str:
    """The address with pixels that software graphics can draw."""
    address, hash_, rest = url.partition("#")
    return f"{address}{'&' if '?' in address else '?'}fixedDpr=0.3{hash_}{rest}"


@pytest.fixture
def open_page(browser: Browser) -> Iterator[Open]:
    """`open_page(url, ready=READY)`: a new person's page, once `ready` holds in it; no script of it may fail.

    size: of the window. own: what this browser has kept (static/browser.js); without plots the scene is larger.
    before: a script that runs before those of the page. motion: what this person wants of the camera, which takes
    two seconds to glide somewhere.
    """
    with fresh_pages(browser) as opened:
        yield opened


@contextmanager
def fresh_pages(browser: Browser) -> Iterator[Open]:
    """The function of `open_page`, and in the end no page."""
    contexts, errors = [], []

    def opened(
        url: str,
        ready: str = READY,
        size: ViewportSize = SIZE,
        own: dict[str, Any] | None = None,
        before: str = "",
        motion: Literal["reduce", "no-preference"] = "reduce",
    ) -> Page:
        contexts.append(browser.new_context(viewport=size, reduced_motion=motion))
        contexts[-1].add_init_script(FEWER_FRAMES)
        contexts[-1].add_init_script(before)
        contexts[-1].add_init_script(KEPT % json.dumps(json.dumps({"plots": "off"} if own is None else own)))
        page = contexts[-1].new_page()
        page.set_default_timeout(PATIENCE)
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.goto(with_query(url))
        page.wait_for_function(ready)
        return page

    yield opened
    for context in contexts:
        context.close()
    assert not errors


@dataclass
class Show:
    """A page of a run that stands still."""

    engine: StillEngine
    server: PageServer

    @property
    def url(self) -> str:
        """Where it is."""
        return self.server.url


@pytest.fixture(scope="module")
def one_show() -> Iterator[Show]:
    """One server for a file of tests; they ask for `show`."""
    engine = StillEngine()
    server = PageServer(engine, port=0)
    server.start()
    yield Show(engine, server)
    server.stop()


@pytest.fixture
def show(one_show: Show) -> Show:
    """The room of tests/page.py, served, as a run that has just begun; nothing was asked of it."""
    one_show.engine.begin(room_snapshot())
    one_show.server.scene.show(asked=frozenset())
    return one_show


@pytest.fixture(scope="module")
def kept(browser: Browser) -> Iterator[Open]:
    """`kept(url, own)`: a page that a file of tests opens once, as it was then: to open another takes seconds.

    For tests that leave nothing behind but what this browser has chosen, where it looks, what Escape closes, and
    the open tab.
    """
    pages: dict[str, Page] = {}
    with fresh_pages(browser) as opened:

        def as_opened(url: str, **own: Any) -> Page:
            if url not in pages:
                pages[url] = opened(url)
                pages[url].evaluate(KEEP)
            page = pages[url]
            page.keyboard.press("Escape")
            page.mouse.move(0, 0)
            page.get_by_role("tab", name="Live").click()
            page.evaluate(AS_OPENED, own)
            return page

        yield as_opened


@pytest.fixture
def again(show: Show, kept: Open) -> Open:
    """`again(own)`: the kept page of `show`, once the run that has just begun is there."""

    def begun(**own: Any) -> Page:
        page = kept(show.url, **own)
        page.wait_for_function(BEGUN)
        return page

    return begun


@pytest.fixture(scope="module")
def bags(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with two short recordings, one with a name that looks like markup."""
    load_everything()
    folder = tmp_path_factory.mktemp("bags")
    for name, scenario in (("kitchen.bag", "rooms"), ("<b>hall<b>.bag", "corridor")):
        simulate(SimulateOptions(scenario=scenario, out=folder / name, duration=4.0, scan_rate=10.0, beams=181))
    return folder


class Opened:
    """A page without a recording, in front of a server that has some."""

    def __init__(self, bags: Path) -> None:
        self.library = Library(self._open, [bags])
        self.engine = Engine(None, START, speed=float("inf"))
        self.engine.offer(self.library)
        self.server = PageServer(self.engine, port=0, upload_limit=UPLOADS)
        self.server.start()
        self.engine.start()

    def _open(self, path: Path, sensors: Mapping[str, Any]) -> Source:
        return open_source(str(path), SourceOptions(**sensors))

    def stop(self) -> None:
        """End both."""
        self.engine.stop()
        self.server.stop()


@pytest.fixture
def opened(bags: Path) -> Iterator[Opened]:
    made = Opened(bags)
    yield made
    made.stop()


@pytest.fixture(scope="module")
def drive() -> list[Item]:
    """Ten seconds through the simulated rooms. Kernels are compiled by then, for longer than a test waits."""
    load_everything()
    return list(Simulation("rooms", SceneOptions(duration=10.0, scan_rate=20.0, beams=181)).items())


@pytest.fixture
def run(drive: list[Item], tmp_path: Path) -> Iterator[panels.Run]:
    """The drive, paused at two seconds; results go to the test's own folder."""
    engine = Engine(MemoryRecording(drive), panels.START, autoplay=False, out=tmp_path)
    server = PageServer(engine, port=0)
    server.start()
    engine.start()
    made = panels.Run(engine, server.url)
    try:
        engine.send(Seek(min(item.stamp_ns for item in drive) + 2 * 10**9))
        made.until(lambda s: s.maps and s.playback.state == "paused")
        yield made
    finally:
        engine.stop()
        server.stop()


@pytest.fixture(scope="module")
def engine(request: pytest.FixtureRequest) -> Iterator[Engine]:
    """At rest at the end of a drive of some metres, with as many beams as BEAMS of the module says."""
    options = SceneOptions(duration=12.0, scan_rate=10.0, beams=request.module.BEAMS)
    with running(MemoryRecording(list(Simulation("rooms", options).items())), speed=float("inf")) as made:
        until(made, lambda now: now.playback.state == "ended", 60.0)
        yield made


@pytest.fixture(scope="module")
def url(engine: Engine) -> Iterator[str]:
    """The page of that run."""
    server = PageServer(engine, port=0)
    server.start()
    yield server.url
    server.stop()
