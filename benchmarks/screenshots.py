"""Takes pictures of the page, in a real Chromium: all of them into build/screenshots, to look at.

    python -m benchmarks.screenshots                  every tab, theme and size of the window
    python -m benchmarks.screenshots --docs           the pictures of the documents, into docs/images
    python -m benchmarks.screenshots --only phone     those whose names have "phone" in them

Each recording is run up to a fixed time and stands still there, so that the same code gives the same picture.
"""

import argparse
import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, Page, ViewportSize, sync_playwright

from benchmarks.xray_pictures import INSIDES, pictures
from hectorscope.cli.opening import Scene, demo_bag
from hectorscope.inputs import SourceOptions
from hectorscope.page.scene import Camera
from hectorscope.run.warmup import load_everything
from hectorscope.session.commands import Seek
from hectorscope.session.engine import Engine
from hectorscope.session.snapshot import Snapshot
from hectorscope.sources import open_source
from hectorscope.web.server import PageServer
from tests.conftest import FLAGS, ROOT, chromium_path
from tests.scene import RESTS

SIZES: dict[str, ViewportSize] = {
    "desk": {"width": 1280, "height": 800},
    "large": {"width": 1920, "height": 1080},
    "tablet-wide": {"width": 1024, "height": 768},
    "tablet-tall": {"width": 768, "height": 1024},
    "phone": {"width": 390, "height": 844},
}
SIZE = SIZES["desk"]
TABS = ("Live", "Filter", "Settings", "Display", "Export", "Log")
READY = "!!window.__viserMutable?.nodeRefFromName?.['/robot'] && !!document.querySelector('.hs-run')"
NOTICE = ".mantine-Notification-closeButton"
PATIENCE_S = 120.0
PICTURES = 20
LOOK_MS = 2500
PAGES = ["Covariance", "Match", "Error against truth", "Attitude", "Biases", "Motion", "Time spent"]
SETTLE_MS = 6000  # textures, plots and the camera's glide, with drawing in software


@dataclass(frozen=True)
class Shot:
    """Which recording, how far into it, and how it is looked at; `own`: what static/browser.js keeps."""

    scene: Scene
    seconds: float
    camera: Camera
    own: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Look:
    """A picture of the whole page: the size of the window, the choices of the browser, the tab, and a key."""

    name: str
    size: str
    own: dict[str, Any]
    tab: str = "Live"
    key: str = ""


SHOTS = (
    Shot("arena", 40.0, "fit", {"theme": "dark"}),
    Shot("littoral", 40.0, "top", {"theme": "light", "layout": "one", "plots": "off"}),
    Shot("handheld", 50.0, "top", {"theme": "dark", "layout": "one", "plots": "off"}),
)
INSIDE = Shot("arena", 20.0, "top", {"theme": "dark", "layout": "one", "plots": "off"})
LOOKED_AT = Shot("arena", 40.0, "fit")


def looks() -> list[Look]:
    """Every tab in every size and both themes, and on a desk each layout."""
    made = []
    for theme in ("dark", "light"):
        for size in SIZES:
            tabs = TABS if size not in ("large", "tablet-wide") else TABS[:1]
            made += [Look(f"{size}-{tab.lower()}-{theme}", size, {"theme": theme}, tab) for tab in tabs]
            made.append(
                Look(f"{size}-plots-{theme}", size, {"theme": theme, "plots": "full", "pages": PAGES}, tab="")
            )
        for size in ("desk", "tablet-tall"):
            made.append(Look(f"{size}-side-{theme}", size, {"theme": theme, "layout": "side"}))
        made.append(Look(f"desk-present-{theme}", "desk", {"theme": theme, "present": True}))
        made.append(Look(f"large-present-{theme}", "large", {"theme": theme, "present": True}))
        alone = {"theme": theme, "panels": False, "plots": "off"}
        made.append(Look(f"desk-alone-{theme}", "desk", alone, tab=""))
        made.append(Look(f"desk-keys-{theme}", "desk", {"theme": theme}, key="?"))
    return made


@contextmanager
def standing_still(shot: Shot) -> Iterator[PageServer]:
    """The page of a run that has come to the wanted time."""
    source = open_source(str(demo_bag(shot.scene)), SourceOptions())
    assert source.span_ns is not None
    wanted_ns = min(source.span_ns[0] + round(shot.seconds * 1e9), source.span_ns[1])
    engine = Engine(source, autoplay=False)
    page = PageServer(engine, port=0)
    engine.start()
    page.start()
    try:
        engine.send(Seek(wanted_ns))
        wait_until(engine, wanted_ns)
        yield page
    finally:
        page.stop()
        engine.stop()


def wait_until(engine: Engine, wanted_ns: int) -> None:
    """Until the run stands at that time; RuntimeError says where it got stuck."""
    ends = time.monotonic() + PATIENCE_S
    snapshot = Snapshot()
    while time.monotonic() < ends and snapshot.playback.state != "failed":
        snapshot = engine.mailbox.latest or snapshot
        resting = snapshot.playback.state in ("paused", "ended")
        if resting and snapshot.scans and snapshot.playback.time_ns >= wanted_ns - 10**9:
            return
        time.sleep(0.1)
    raise RuntimeError(f"{snapshot.source} stands {snapshot.playback}")


def opened(browser: Browser, server: PageServer, size: ViewportSize, own: dict[str, Any]) -> Page:
    """A new person's page with these choices; the notice that drawing is done in software is closed."""
    context = browser.new_context(viewport=size)
    context.add_init_script(f"localStorage.setItem('hectorscope', {json.dumps(json.dumps(own))})")
    page = context.new_page()
    page.goto(f"{server.url}?fixedDpr=1")  # else a slow machine draws it coarsely
    page.wait_for_function(READY, timeout=PATIENCE_S * 1000)
    page.wait_for_timeout(LOOK_MS)
    for notice in page.locator(NOTICE).all():
        notice.click()
    return page


def take(browser: Browser, shot: Shot, folder: Path) -> Path:
    """One picture of the documents."""
    target = folder / f"{shot.scene}.png"
    with standing_still(shot) as server:
        page = opened(browser, server, SIZE, shot.own)
        server.scene.camera(shot.camera)
        target.write_bytes(settled(page))
        page.context.close()
    return target


def take_inside(browser: Browser, folder: Path, only: str) -> Iterator[Path]:
    """The pictures of what happens inside the matcher."""
    if not any(only in f"xray-{inside.name}" for inside in INSIDES):
        return
    with standing_still(INSIDE) as server:
        page = opened(browser, server, SIZE, INSIDE.own)
        yield from pictures(page, settled, folder, only)
        page.context.close()


def take_looks(browser: Browser, wanted: list[Look], folder: Path) -> Iterator[Path]:
    """Pictures of one run, one after another."""
    with standing_still(LOOKED_AT) as server:
        for look in wanted:
            page = opened(browser, server, SIZES[look.size], look.own)
            if look.tab:
                page.get_by_role("tab", name=look.tab).click()
            if look.key:
                page.keyboard.press(look.key)
            page.wait_for_function(RESTS, timeout=PATIENCE_S * 1000)
            page.wait_for_timeout(LOOK_MS)
            target = folder / f"{look.name}.png"
            target.write_bytes(page.screenshot())
            page.context.close()
            yield target


def settled(page: Page) -> bytes:
    """The picture once two in a row are the same: a busy machine glides slowly, and draws coarsely meanwhile."""
    before = b""
    for _ in range(PICTURES):
        page.wait_for_timeout(SETTLE_MS)
        picture = page.screenshot()
        if picture == before:
            return picture
        before = picture
    raise RuntimeError("the page does not come to rest: leave it more of the machine")


def main() -> None:
    """Take the pictures that were asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--docs", action="store_true", help="the pictures of the documents")
    parser.add_argument("--only", default="", help="part of a picture's name")
    parser.add_argument("--out", type=Path)
    chosen = parser.parse_args()
    folder = chosen.out or ROOT / ("docs/images" if chosen.docs else "build/screenshots")
    folder.mkdir(parents=True, exist_ok=True)
    load_everything()  # the compiler's time is not the run's
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium_path(), args=FLAGS)
        if chosen.docs:
            some = (take(browser, shot, folder) for shot in SHOTS if chosen.only in shot.scene)
            taken: Iterator[Path] = chain(some, take_inside(browser, folder, chosen.only))
        else:
            taken = take_looks(browser, [look for look in looks() if chosen.only in look.name], folder)
        for path in taken:
            print(path, flush=True)
        browser.close()


if __name__ == "__main__":
    main()
