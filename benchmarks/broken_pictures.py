"""Takes the pictures of docs/broken-recordings.md: recordings that are broken on purpose, as the page shows them.

python -m benchmarks.broken_pictures
"""

import argparse
import io
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from PIL import Image
from playwright.sync_api import Browser, Page, ViewportSize, sync_playwright

from benchmarks.broken import BREAKS, GAP_FROM_S, make
from benchmarks.screenshots import opened, settled
from hectorscope.checks.sensor_check import CheckedSource
from hectorscope.cli.opening import demo_bag
from hectorscope.inputs import SourceOptions
from hectorscope.run.warmup import load_everything
from hectorscope.session.commands import Examine, Seek
from hectorscope.session.engine import Engine
from hectorscope.sources import open_source
from hectorscope.web.server import PageServer
from tests.conftest import FLAGS, ROOT, chromium_path
from tests.engines import until

SIZE: ViewportSize = {"width": 1100, "height": 700}
COLOURS = 96  # of a picture, which keeps the files small
PATIENCE_S = 180.0
SHOWN_S = {"gap": GAP_FROM_S + 1.6, "unit": 0.0, "clock": 40.0}
OWN = {"pages": ["Match"], "window": 120, "height": 190, "layout": "one"}


@contextmanager
def standing(broken: Path, seconds: float) -> Iterator[tuple[Engine, PageServer]]:
    """The page of a recording that was examined and stands at a time, or was refused."""
    source = CheckedSource(partial(open_source, str(broken)), SourceOptions())
    engine = Engine(source, speed=float("inf"))
    page = PageServer(engine, port=0)
    page.start()
    engine.start()
    try:
        end = until(engine, lambda now: now.playback.state in ("ended", "failed"), PATIENCE_S)
        engine.send(Examine())
        until(engine, lambda now: now.examined is not None, PATIENCE_S)
        if end.playback.state == "ended":
            engine.send(Seek(end.playback.start_ns + round(seconds * 1e9)))
            until(engine, lambda now: now.obeyed == engine.sent and now.playback.state == "paused", PATIENCE_S)
        yield engine, page
    finally:
        page.stop()
        engine.stop()


def picture(page: Page, target: Path) -> None:
    """Save what the page shows, in few colours."""
    image = Image.open(io.BytesIO(settled(page))).convert("RGB")
    image.quantize(COLOURS, dither=Image.Dither.NONE).save(target, optimize=True)


def take(browser: Browser, whole: Path, how: str, folder: Path, target: Path) -> Path:
    """One picture, of the tab with what was found."""
    with standing(make(whole, folder / f"{how}.bag", how), SHOWN_S[how]) as (_, server):
        page = opened(browser, server, SIZE, OWN)
        page.get_by_role("tab", name="Log").click()
        picture(page, target)
        page.context.close()
    return target


def main() -> None:
    """All three into docs/images."""
    argparse.ArgumentParser(description=__doc__.splitlines()[0]).parse_args()
    load_everything()
    with sync_playwright() as playwright, tempfile.TemporaryDirectory() as folder:
        browser = playwright.chromium.launch(executable_path=chromium_path(), args=FLAGS)
        for how in BREAKS:
            target = ROOT / "docs" / "images" / f"broken-{how}.png"
            print(take(browser, demo_bag("arena"), how, Path(folder), target), flush=True)
        browser.close()


if __name__ == "__main__":
    main()
