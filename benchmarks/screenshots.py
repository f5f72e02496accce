"""Takes the pictures of the documents: the real page on each demo recording, in a real Chromium.

    python -m benchmarks.screenshots [--scene arena] [--out docs/images]

Each recording is run up to a fixed time and stands still there, so that the same code gives the same picture.
"""

import argparse
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, Page, ViewportSize, sync_playwright

from hectorscope.cli.main import Scene, demo_bag
from hectorscope.inputs import SourceOptions
from hectorscope.page.scene import Camera
from hectorscope.run.warmup import load_everything
from hectorscope.session.commands import Seek
from hectorscope.session.engine import Engine
from hectorscope.session.snapshot import Snapshot
from hectorscope.sources import open_source
from hectorscope.web.server import PageServer
from tests.conftest import ROOT, chromium_path

SIZE: ViewportSize = {"width": 1280, "height": 800}
FLAGS = [
    "--no-sandbox",  # also runs as root, as in a container; it only opens our own page
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--disable-background-networking",
    "--no-first-run",
]
NOTICE = ".mantine-Notification-closeButton"
PATIENCE_S = 120.0
PICTURES = 20
SETTLE_MS = 6000  # textures, plots and the camera's glide, with drawing in software


@dataclass(frozen=True)
class Shot:
    """Which recording, how far into it, and how it is looked at; `display` names fields of Display."""

    scene: Scene
    seconds: float
    camera: Camera
    display: dict[str, Any]


SHOTS = (
    Shot("arena", 40.0, "fit", {"dark": True}),
    Shot("littoral", 40.0, "top", {"dark": False, "layout": "one"}),
    Shot("handheld", 50.0, "top", {"dark": True, "layout": "one"}),
)


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
        page.scene.show(**shot.display)
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


def take(browser: Browser, shot: Shot, folder: Path) -> Path:
    """One picture."""
    target = folder / f"{shot.scene}.png"
    with standing_still(shot) as server:
        page = browser.new_page(viewport=SIZE, color_scheme="dark" if shot.display["dark"] else "light")
        page.goto(f"{server.url}?fixedDpr=1")  # else a slow machine draws it coarsely
        page.wait_for_function("window.__viserMutable?.nodeRefFromName?.['/robot']", timeout=PATIENCE_S * 1000)
        page.wait_for_timeout(SETTLE_MS)
        for notice in page.locator(NOTICE).all():  # that drawing is done in software
            notice.click()
        server.scene.camera(shot.camera)
        target.write_bytes(settled(page))
        page.close()
    return target


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
    """Take the pictures that were asked for, or all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scene", choices=[shot.scene for shot in SHOTS], help="only this one")
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "images")
    chosen = parser.parse_args()
    chosen.out.mkdir(parents=True, exist_ok=True)
    load_everything()  # the compiler's time is not the run's
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium_path(), args=FLAGS)
        for shot in SHOTS:
            if chosen.scene in (None, shot.scene):
                print(take(browser, shot, chosen.out))
        browser.close()


if __name__ == "__main__":
    main()
