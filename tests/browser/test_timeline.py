"""The timeline, by a person's means, on a real engine that has run ahead."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page, expect

from hectorscope.inputs import Item
from hectorscope.run.warmup import load_everything
from hectorscope.session.commands import Configure, Seek
from hectorscope.session.engine import Engine
from hectorscope.session.snapshot import Snapshot
from hectorscope.simulation import SceneOptions, Simulation
from hectorscope.web.server import PageServer
from slam_core.measurements import LaserScan
from tests.browser.conftest import Open
from tests.cases import quick_first
from tests.engines import START, after, until
from tests.page import LATE_CAMERA
from tests.sources import MemoryRecording, MemoryStream
from tests.streams import Robot

pytestmark = pytest.mark.browser

S = 10**9
PATIENCE_S = 120.0
STATE = "window.hectorscope.timeline.state()"
# A place of the window where nothing lies over the scene.
OVER_THE_SCENE = """() => {
  const box = window.__viserMutable.canvas.getBoundingClientRect();
  return [box.left + 0.5 * box.width, box.top + 0.2 * box.height];
}"""
SIZES = {"desk": (1280, 800), "tablet": (768, 1024), "phone": (390, 844)}
LIT = """() => {
  const canvas = document.querySelector('.hs-timeline-track canvas');
  const { width, height } = canvas, top = Math.round(0.5 * height);
  const { data } = canvas.getContext('2d').getImageData(0, top, width, height - top);
  return new Set(Array.from({ length: width * (height - top) }, (_, i) => i).filter((i) => data[4 * i + 3])
    .map((i) => i % width)).size / width;
}"""

# Time stands still for the scripts of the page, so that nothing runs out of it; from now on drawings are noted.
JUMP = """(seconds) => {
  const { drawing, jump, timeline } = window.hectorscope;
  const [now, cells] = [performance.now(), window.__viserMutable.nodeRefFromName['/floor/map/level0/cells']];
  const picture = () => {
    let found = null;
    cells.traverse((part) => (found ??= part.material?.map));
    return found;
  };
  const old = picture();
  performance.now = () => now;
  window.drawings = [];
  drawing.push(() => window.drawings.push(picture() === old ? 'old' : 'new'));
  seconds === null ? jump.begin(1e6) : timeline.seek(seconds);
}"""
DRAWN = """() => new Promise((done) => {
  const next = () => (window.drawings.length ? done() : requestAnimationFrame(next));
  next();
})"""
FRAMES = """() => new Promise((done) => {
  let left = 20;
  const next = () => (left-- ? requestAnimationFrame(next) : done(window.drawings.length));
  next();
})"""


class Bench:
    """An engine at rest in the middle of a drive with some blind scans, and its page."""

    def __init__(self, drive: list[Item]) -> None:
        self.start_ns = drive[0].stamp_ns
        self.engine = Engine(MemoryRecording(drive), START, autoplay=False)
        self.server = PageServer(self.engine, port=0)
        self.server.start()
        self.engine.start()
        until(self.engine, lambda now: now.ahead.whole, PATIENCE_S)
        after(self.engine, Seek(self.start_ns + 5 * S))

    def until(self, holds: Callable[[Snapshot], Any]) -> Snapshot:
        """The first snapshot that rests and `holds`."""
        return until(
            self.engine,
            lambda now: now.obeyed == self.engine.sent and now.playback.state == "paused" and holds(now),
            PATIENCE_S,
        )

    def seconds(self, snapshot: Snapshot) -> float:
        """Where a snapshot is."""
        return (snapshot.playback.time_ns - self.start_ns) / 1e9


@pytest.fixture(scope="module")
def drive() -> list[Item]:
    """Ten seconds through the simulated rooms; at 3 s and at 7 s the laser sees nothing that is there."""
    load_everything()
    items = list(Simulation("rooms", SceneOptions(duration=10.0, scan_rate=20.0, beams=181)).items())
    begin = items[0].stamp_ns

    def spoilt(item: Item) -> Item:
        near = any(abs((item.stamp_ns - begin) / 1e9 - at) < 0.08 for at in (3.0, 7.0))
        return (
            replace(item, ranges=np.full_like(item.ranges, 0.7)) if isinstance(item, LaserScan) and near else item
        )

    return [spoilt(item) for item in items]


@pytest.fixture
def bench(drive: list[Item]) -> Iterator[Bench]:
    made = Bench(drive)
    try:
        yield made
    finally:
        made.server.stop()
        made.engine.stop()


def opened(bench: Bench, open_page: Open, size: str = "desk") -> Page:
    """The page, once the timeline has its marks and the rows of the whole recording."""
    width, height = SIZES[size]
    page = open_page(bench.server.url, size={"width": width, "height": height})
    rows = len(bench.until(lambda now: now.ahead.whole).ahead.series)
    page.wait_for_function(f"{STATE}.marks.length && window.hectorscope.plotted().tables.series?.known === {rows}")
    return page


def test_a_page_that_asks_before_the_server_knows_it_asks_again(bench: Bench, open_page: Open) -> None:
    """Timeline and curves come once it is known, however late its camera has told where it is."""
    page = open_page(bench.server.url, before=LATE_CAMERA, own={})
    page.wait_for_timeout(1500)
    assert page.evaluate(f"[{STATE}.end, window.hectorscope.plotted().tables.series ?? null]") == [None, None]
    page.evaluate("window.cameraHeard = true")
    page.mouse.move(*page.evaluate(OVER_THE_SCENE))
    page.mouse.wheel(0, 50)
    page.wait_for_function(f"{STATE}.marks.length && window.hectorscope.plotted().tables.series?.known > 100")


def track(page: Page) -> dict[str, float]:
    box = page.locator(".hs-timeline-track").bounding_box()
    assert box is not None
    return dict(box)


def test_a_drag_shows_the_run_on_its_way_and_ends_where_it_is_left(bench: Bench, open_page: Open) -> None:
    """Back and forth, with the pointer held; the curves end at the shown scan, and the head is there."""
    page, box = opened(bench, open_page), None
    box = track(page)
    y = box["y"] + 0.6 * box["height"]
    page.mouse.move(box["x"] + 0.5 * box["width"], y)
    page.mouse.down()
    for share in np.linspace(0.5, 0.15, 12):
        page.mouse.move(box["x"] + float(share) * box["width"], y)
    held = 0.15 * page.evaluate(f"{STATE}.end")
    bench.until(lambda now: bench.seconds(now) == pytest.approx(held, abs=0.2))
    page.mouse.move(box["x"] + 0.8 * box["width"], y)
    page.mouse.up()
    end = 0.8 * page.evaluate(f"{STATE}.end")
    left = bench.until(lambda now: bench.seconds(now) == pytest.approx(end, abs=0.2))
    page.wait_for_function(f"window.hectorscope.plotted().tables.series.count === {len(left.series)}")
    page.wait_for_function(f"{STATE}.wanted === null && {STATE}.at > 7.0")
    assert float(page.locator(".hs-timeline-track").get_attribute("aria-valuenow") or 0) > 7.0


def test_keys_and_buttons_go_from_mark_to_mark(bench: Bench, open_page: Open) -> None:
    """To the next bad match and to the one before, in any browser; each says what it is under the pointer."""
    page = opened(bench, open_page)
    page.locator("canvas[data-engine]").focus()
    page.keyboard.press("n")
    assert bench.seconds(bench.until(lambda now: bench.seconds(now) > 6.0)) == pytest.approx(7.0, abs=0.15)
    page.get_by_role("button", name="Mark before").click()
    back = bench.until(lambda now: bench.seconds(now) < 4.0)
    assert bench.seconds(back) == pytest.approx(3.0, abs=0.15)
    assert back.result is not None
    assert back.result.tracking == "degraded"
    page.get_by_role("button", name="Next mark").click()
    bench.until(lambda now: bench.seconds(now) > 6.0)
    page.keyboard.press("Shift+N")
    bench.until(lambda now: bench.seconds(now) < 4.0)
    at, end = page.evaluate(f"[{STATE}.marks.find(([, kind]) => kind === 'bad_match')[0], {STATE}.end]")
    box = track(page)
    page.mouse.move(box["x"] + at / end * box["width"], box["y"] + 8)
    expect(page.locator(".hs-timeline-tip")).to_contain_text("rejected")
    expect(page.locator(".hs-timeline-tip")).to_contain_text("scan ")
    page.keyboard.press("?")
    expect(page.locator(".hs-keys")).to_contain_text("next mark")


def test_a_change_of_settings_is_a_mark(bench: Bench, open_page: Open) -> None:
    """And what is known behind it is run again."""
    page = opened(bench, open_page)
    after(bench.engine, Configure("fusion.omega", 0.4))
    page.wait_for_function(
        f"{STATE}.marks.some(([, kind, , text]) => kind === 'setting' && text.includes('omega'))"
    )
    page.wait_for_function(f"{STATE}.whole && {STATE}.known > 9")


@pytest.mark.parametrize("size", quick_first(SIZES, 2))
def test_a_strip_of_any_series_is_shown_over_the_whole_recording(bench: Bench, open_page: Open, size: str) -> None:
    """Also behind what is shown; the choice stays in the browser. Nothing of it is outside of the window."""
    page = opened(bench, open_page, size)
    page.wait_for_function(f"({LIT})() > 0.7")
    page.get_by_label("Strip").select_option("σ x, mm")
    page.reload()
    page.wait_for_function(f"window.hectorscope?.timeline && {STATE}.end")
    expect(page.get_by_label("Strip")).to_have_value("σ x, mm")
    page.wait_for_function(f"({LIT})() > 0.7")
    width, height = SIZES[size]
    for part in (".hs-timeline-track", ".hs-strip", ".hs-clock"):
        box = page.locator(part).bounding_box()
        assert box is not None
        assert box["x"] >= 0 and box["x"] + box["width"] <= width, part
        assert box["y"] >= 0 and box["y"] + box["height"] <= height, part


def test_arrows_move_the_head_by_seconds(bench: Bench, open_page: Open) -> None:
    """The timeline is a slider to the keyboard and to screen readers."""
    page = opened(bench, open_page)
    slider = page.get_by_role("slider", name="Timeline")
    slider.focus()
    slider.press("ArrowLeft")
    assert bench.seconds(bench.until(lambda now: bench.seconds(now) < 4.5)) == pytest.approx(4.0, abs=0.15)
    slider.press("Home")
    bench.until(lambda now: now.scans == 0)
    expect(slider).to_have_attribute("aria-valuetext", "00:00.0")


@pytest.fixture
def robot(drive: list[Item]) -> Iterator[tuple[Robot, str]]:
    """A stream that has come to the middle of the drive, and its page."""
    stream = MemoryStream()
    engine = Engine(stream, START)
    server = PageServer(engine, port=0)
    server.start()
    engine.start()
    made = Robot(engine, stream, drive)
    try:
        made.drive_on(8.0)
        yield made, server.url
    finally:
        server.stop()
        engine.stop()


@pytest.mark.slow
def test_a_stream_is_scrubbed_while_it_goes_on(robot: tuple[Robot, str], open_page: Open) -> None:
    """Dragged back it says how far behind that is; the run goes on, and one key leads back to now."""
    made, url = robot
    page = open_page(url, size={"width": 1280, "height": 800})
    page.wait_for_function(f"{STATE}.end > 7")
    box = track(page)
    page.mouse.move(box["x"] + 0.9 * box["width"], box["y"] + 30)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 30, steps=5)
    page.mouse.up()
    page.wait_for_function(f"{STATE}.wanted === null")
    there = made.until(lambda now: now.playback.state == "paused" and (now.playback.lag or 0.0) > 2.0)
    expect(page.locator(".hs-detail")).to_contain_text("behind by")
    on = made.drive_on(9.5)
    assert on.scans == there.scans
    page.wait_for_function(f"{STATE}.end > 9")
    button = page.get_by_role("button", name="Now")
    expect(button).to_be_visible()
    page.locator("canvas[data-engine]").focus()
    page.keyboard.press("l")
    now = made.until(lambda now: now.playback.lag is None)
    assert now.scans == len(now.ahead.series) > there.scans
    expect(button).to_be_hidden()


def test_the_first_drawing_behind_a_jump_has_the_map_of_that_time(bench: Bench, open_page: Open) -> None:
    """None before it: it would be the old map, or the new robot on it."""
    page = opened(bench, open_page)
    page.evaluate(JUMP, 9.0)
    page.evaluate(DRAWN)
    assert set(page.evaluate("window.drawings")) == {"new"}


def test_a_hand_that_turns_the_view_sees_it_turn_during_a_jump(bench: Bench, open_page: Open) -> None:
    """The wheel over the scene ends the waiting; over the panel it does not."""
    page = opened(bench, open_page)
    page.mouse.move(1240, 300)
    page.evaluate(JUMP)
    page.mouse.wheel(0, 10)
    assert page.evaluate(FRAMES) == 0
    page.mouse.move(400, 300)
    page.mouse.wheel(0, 10)
    page.evaluate(DRAWN)


def test_a_jump_that_takes_long_is_not_waited_for(bench: Bench, open_page: Open) -> None:
    """The scene moves again after half a second, wherever the run is by then."""
    page = opened(bench, open_page)
    page.evaluate(JUMP)
    assert page.evaluate(FRAMES) == 0
    page.evaluate("() => { const now = performance.now() + 501; performance.now = () => now; }")
    page.evaluate(DRAWN)
