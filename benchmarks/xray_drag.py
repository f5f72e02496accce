"""How soon the card of the X-ray follows a dragged start and a slider, in a Chromium that draws in software."""

import os
import statistics
import time

import numpy as np
from playwright.sync_api import Page, sync_playwright

from benchmarks.screenshots import SIZE
from hectorscope.run.xray.match_problem import problem_of
from hectorscope.session.commands import Seek
from hectorscope.session.engine import Engine
from hectorscope.simulation import SceneOptions, Simulation
from hectorscope.web.server import PageServer
from tests.conftest import FLAGS, chromium_path
from tests.engines import after, running, until
from tests.scene import choose_own, look
from tests.sources import MemoryRecording
from tests.xray import grip

MOVES, MOVE_S = 160, 1 / 16
METRES = 1.0  # to each side of the start
PATIENCE_MS = 120_000
READY = "window.hectorscope?.levels?.().places.length && window.hectorscope.xray"
HANDLE = "() => !!window.__viserMutable.nodeRefFromName['/floor/xray_start']"
# Keeps the times, in milliseconds, at which the words of the card change.
WATCH = """() => {
  window.followed = [];
  const card = document.querySelector(".hs-xray-words");
  new MutationObserver(() => window.followed.push(performance.now())).observe(card, { childList: true });
}"""

# Moves the slider of omega, and gives the milliseconds until its value stands in the words of the card, drawn.
SLIDE = """async (omega) => {
  const slider = document.querySelector("input[data-hs-xray=omega]");
  const words = document.querySelector(".hs-xray-words");
  const begin = performance.now();
  slider.value = omega;
  slider.dispatchEvent(new Event("input", { bubbles: true }));
  while (!words.textContent.includes(`ω ${omega.toFixed(3)}`)) await new Promise(requestAnimationFrame);
  return performance.now() - begin;
}"""
SLIDES, SLIDE_S = 40, 0.3


def dragged(page: Page, begin: np.ndarray, finish: np.ndarray) -> tuple[int, float]:
    """How many poses the mouse was moved to, back and forth, and the seconds it took."""
    page.mouse.move(*begin.tolist())
    page.evaluate("() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)))")
    page.mouse.down()
    page.mouse.move(*(begin + 0.1 * (finish - begin)).tolist())
    page.evaluate(WATCH)
    started = time.monotonic()
    for k in range(MOVES):
        page.mouse.move(*(begin + np.sin(0.1 * (k + 1)) * (finish - begin)).tolist())
        time.sleep(max(0.0, started + (k + 1) * MOVE_S - time.monotonic()))
    took = time.monotonic() - started
    page.mouse.up()
    return MOVES, took


def followed(engine: Engine, page: Page, url: str, seconds: float) -> str:
    """A line that says how often the card followed; seconds: after the start of the recording, where it rests."""
    latest = engine.mailbox.latest
    assert latest is not None
    now = after(engine, Seek(latest.playback.start_ns + round(seconds * 1e9)))
    assert now.rework is not None and now.result is not None
    inside = problem_of(now.rework.before(now.ahead.settings), now.result, now.config)
    assert inside is not None
    page.goto(f"{url}?fixedDpr=0.3")
    page.wait_for_function(READY, timeout=PATIENCE_MS)
    choose_own(page, layout="one", plots="off")
    look(page, "follow")
    look(page, "top")
    page.keyboard.press("i")
    page.evaluate("window.hectorscope.xray.want('lab', 'landscape')")
    page.locator(".hs-xray-words", has_text="ends at").wait_for(timeout=PATIENCE_MS)
    page.wait_for_function(HANDLE, timeout=PATIENCE_MS)
    moves, took = dragged(page, *grip(page, inside.start, METRES))
    times: list[float] = page.evaluate("window.followed")
    if len(times) < 2:
        raise SystemExit("the handle was not dragged: the page was too busy to notice the mouse")
    apart = statistics.median(np.diff(times).tolist())
    slid = slides(page)
    tenth = statistics.quantiles(slid, n=10)[-1]
    return (
        f"{moves / took:.1f} poses a second for {took:.0f} s: the card followed {len(times) / took:.1f} times a"
        f" second ({apart:.0f} ms from one to the next in the median; load {os.getloadavg()[0]:.1f})\n"
        f"ω by its slider {SLIDES} times: shown after {statistics.median(slid):.0f} ms in the median,"
        f" {tenth:.0f} ms in the slowest tenth, {max(slid):.0f} ms at most"
    )


def slides(page: Page) -> list[float]:
    """Milliseconds from each move of the slider to the words with its value."""
    page.evaluate("window.hectorscope.xray.want('lab', 'covariance')")
    page.locator(".hs-xray-words", has_text="best ω").wait_for(timeout=PATIENCE_MS)
    took = []
    for omega in np.linspace(0.1, 0.9, SLIDES):
        took.append(float(page.evaluate(SLIDE, round(float(omega), 3))))
        time.sleep(SLIDE_S)
    return took


def measure(seconds: float, beams: int) -> str:
    """The same, near the end of a drive through rooms."""
    options = SceneOptions(duration=seconds, scan_rate=10.0, beams=beams)
    with running(MemoryRecording(list(Simulation("rooms", options).items())), speed=float("inf")) as engine:
        until(engine, lambda now: now.playback.state == "ended")
        server = PageServer(engine, port=0)
        server.start()
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=chromium_path(), args=FLAGS)
            try:
                return followed(engine, browser.new_page(viewport=SIZE), server.url, seconds - 1.0)
            finally:
                browser.close()
                server.stop()
