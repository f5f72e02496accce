"""A shared replay in a real browser, from the disk: it plays, and shows what was there at each time."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser, Page, expect

from hectorscope.exporters import chosen, run
from hectorscope.run.notes import Note
from hectorscope.simulation import SceneOptions, Simulation
from hectorscope.web.shared_replay import exporter
from tests.engines import START
from tests.sources import MemoryRecording

pytestmark = pytest.mark.browser
NOTES = (Note(3.0, "here <b>it</b> turns</script>"), Note(9.0, "back again"))
ROBOT = "window.__viserMutable?.nodeRefFromName?.['/robot']?.position.toArray()"
# Pressed, and again as soon as time has gone on: on a busy machine the drive would else be over by then.
PLAYED = """(button) => new Promise((done) => {
  button.click();
  const look = setInterval(() => {
    if (window.hectorscope.replay.now() < 1.5) return;
    clearInterval(look);
    button.click();
    done();
  }, 20);
})"""
NOW = "window.hectorscope.replay.now()"


@pytest.fixture(scope="module")
def replay(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, np.ndarray]:
    """The file of a drive through the rooms, and its trajectory."""
    folder = tmp_path_factory.mktemp("replay")
    drive = list(Simulation("rooms", SceneOptions(duration=12.0, scan_rate=10.0, beams=181)).items())
    formats = chosen("html,tum", [exporter(NOTES, "rooms <1>")])
    run(MemoryRecording(drive), START, folder, truth=None, progress=lambda _: None, formats=formats)
    rows = np.loadtxt(folder / "trajectory.tum")
    rows[:, 0] -= 1.7e9
    return folder / "replay.html", rows


@pytest.fixture
def page(browser: Browser, replay: tuple[Path, np.ndarray]) -> Iterator[Page]:
    """Opened from the disk; no script of it may fail, and it asks for nothing but itself."""
    page, errors, asked = browser.new_page(viewport={"width": 1100, "height": 700}), [], []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("request", lambda request: asked.append(request.url))
    page.goto(f"{replay[0].as_uri()}?fixedDpr=0.3")
    page.wait_for_function(f"{ROBOT}?.some((value) => value !== 0)")
    yield page
    page.close()
    assert not errors
    assert {url.split("?")[0] for url in asked if not url.startswith(("data:", "blob:"))} == {replay[0].as_uri()}


def test_it_plays_from_the_disk(page: Page) -> None:
    """Time goes on by itself, and the robot moves; the button rests it."""
    page.evaluate("window.hectorscope.replay.play(false); window.hectorscope.replay.go(1)")
    there = page.evaluate(ROBOT)
    page.get_by_role("button", name="Play").evaluate(PLAYED)
    expect(page.get_by_role("button", name="Play")).to_be_visible()
    page.wait_for_function(f"(there) => String({ROBOT}) !== String(there)", arg=there)
    assert not page.evaluate("window.hectorscope.replay.playing()")
    expect(page.locator("h1")).to_have_text("rooms <1>")


def test_the_scene_is_that_of_the_time_forwards_and_back(page: Page, replay: tuple[Path, np.ndarray]) -> None:
    """The robot stands where the trajectory has it, to a scan."""
    page.evaluate("window.hectorscope.replay.play(false)")
    for seconds in (10.0, 4.0, 7.5):
        page.evaluate(f"window.hectorscope.replay.go({seconds})")
        row = replay[1][np.searchsorted(replay[1][:, 0], seconds + 0.01) - 1]
        near = f"(([x, y]) => Math.hypot(x - {row[1]}, y - {row[2]}) < 0.15)({ROBOT})"
        page.wait_for_function(near)


def test_notes_and_log_lead_to_their_times(page: Page) -> None:
    """A click goes there; the note then stands over the scene, as the text that it is."""
    lines = page.locator(".hs-side section", has_text="Notes").locator("li")
    expect(lines).to_have_count(len(NOTES))
    lines.first.get_by_role("button").click()
    assert page.evaluate(NOW) == NOTES[0].seconds
    expect(page.locator(".hs-caption")).to_have_text(NOTES[0].text)
    expect(lines.first).to_have_attribute("aria-current", "true")
    expect(page.locator(".hs-side figure").first).to_contain_text("Mean residual")
    page.keyboard.press("ArrowRight")
    assert page.evaluate(NOW) == NOTES[0].seconds + 1.0
