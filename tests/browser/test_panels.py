"""The controls of the page, moved by a person's means, on a real engine."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import expect

from hectorscope.session.commands import Configure, Seek, SetSpeed
from tests.browser.conftest import Open
from tests.panels import Run, button, choose, open_tab, row

pytestmark = pytest.mark.browser

LET_GO = "document.activeElement === document.body"


def test_play_pause_step_and_restart(run: Run, open_page: Open) -> None:
    """The buttons at the bottom do what they say, and the first one tells what it would do next."""
    page, stopped = open_page(run.url), run.now
    run.engine.send(SetSpeed(0.1))  # so that the drive has not ended by the time of the click on a busy machine
    button(page, "Step one scan").click()
    assert run.until(lambda s: s.scans > stopped.scans).scans == stopped.scans + 1
    button(page, "Play").click()
    run.until(lambda s: s.playback.state == "playing" and s.scans > stopped.scans + 3)
    button(page, "Pause").click()
    run.until(lambda s: s.playback.state == "paused")
    button(page, "Restart").click()
    run.until(lambda s: s.epoch > stopped.epoch)


def test_the_results_are_saved(run: Run, open_page: Open, tmp_path: Path) -> None:
    """The button leaves the map for --map; a notice and the log say where."""
    page = open_page(run.url)
    button(page, "Save the results").click()
    run.until(lambda s: str(tmp_path) in s.log[-1].text)
    assert (tmp_path / "map.npz").exists()
    expect(page.locator(".mantine-Notification-root", has_text="Saved map.npz, ")).to_be_visible()
    open_tab(page, "Log")
    expect(page.locator(".hs-log-list")).to_contain_text("Saved map.npz, ")


def test_hotkeys(run: Run, open_page: Open) -> None:
    """Space, full stop, comma, brackets and R, also while a button has the focus that the pointer gave it."""
    page, stopped = open_page(run.url), run.now
    button(page, "Step one scan").click()
    assert run.until(lambda s: s.scans > stopped.scans).scans == stopped.scans + 1
    page.keyboard.press(".")
    run.until(lambda s: s.scans == stopped.scans + 2 and s.playback.state == "paused")
    page.keyboard.press(",")
    run.until(lambda s: s.scans == stopped.scans + 1 and s.playback.state == "paused")
    page.keyboard.press("]")
    run.until(lambda s: s.playback.speed == 2.0)
    page.keyboard.press("[")
    run.until(lambda s: s.playback.speed == 1.0)
    page.keyboard.press("Space")
    run.until(lambda s: s.playback.state == "playing")
    page.keyboard.press("r")
    run.until(lambda s: s.epoch > stopped.epoch)


def test_hotkeys_after_a_click(run: Run, open_page: Open) -> None:
    """What was clicked does not keep the keyboard: a box stays as it is, a choice is not typed into."""
    page = open_page(run.url)
    run.engine.send(SetSpeed(0.1))  # so that the drive has not ended by the last key on a busy machine
    open_tab(page, "Settings")
    box = row(page, "Planar").get_by_role("checkbox")
    box.click()
    run.until(lambda s: s.config.platform.planar)
    page.wait_for_function(LET_GO)
    page.keyboard.press("Space")
    run.until(lambda s: s.playback.state == "playing")
    expect(box).to_be_checked()
    choose(page, "bar-transport", "0.25×")
    run.until(lambda s: s.playback.speed == 0.25)
    page.wait_for_function(LET_GO)
    page.keyboard.press("Space")
    run.until(lambda s: s.playback.state == "paused")


def test_a_click_in_the_log_goes_there(run: Run, open_page: Open) -> None:
    """To the scan after which it happened, from later on, where the run rests."""
    run.engine.send(Configure("fusion.omega", 0.3))
    there = run.until(lambda s: s.config.fusion.omega == 0.3)
    run.engine.send(Seek(there.playback.time_ns + 3 * 10**9))
    later = run.until(lambda s: s.scans > there.scans + 50 and s.playback.state == "paused")
    page = open_page(run.url)
    open_tab(page, "Log")
    entry = page.locator(".hs-log-list li", has_text="fusion.omega: 0.1 → 0.3")
    expect(entry.locator("small")).to_have_text(f"scan {there.scans}")
    entry.get_by_role("button").click()
    back = run.until(lambda s: s.epoch > later.epoch and s.playback.state == "paused")
    assert (back.scans, back.playback.time_ns) == (there.scans, there.playback.time_ns)


def test_a_picture_of_the_scene_is_saved(run: Run, open_page: Open, tmp_path: Path) -> None:
    """As this browser shows it, with the map and what is around it, as a PNG file."""
    page = open_page(run.url)
    open_tab(page, "Export")
    with page.expect_download() as download:
        button(page, "Save a picture").click()
    assert download.value.suggested_filename == "hectorscope.png"
    download.value.save_as(tmp_path / "picture.png")
    picture = Image.open(tmp_path / "picture.png").convert("RGBA")
    assert picture.getextrema()[3] == (255, 255)
    pixels = np.asarray(picture.convert("L"))
    assert min(pixels.shape) > 50
    assert np.ptp(pixels) > 100


def test_the_page_has_no_settings_but_its_own(run: Run, open_page: Open) -> None:
    """Viser's icon for its own settings, which would take the place of the panel, is hidden."""
    page = open_page(run.url)
    icon = page.locator(".tabler-icon-adjustments")
    expect(icon).to_have_count(1)
    expect(icon).to_be_hidden()


def test_the_timeline_jumps(run: Run, open_page: Open) -> None:
    """A click in the middle of the timeline goes there, and the slider stays there."""
    page = open_page(run.url)
    expect(page.locator(".hs-clock b")).to_have_text("00:02.0")  # the bar knows the recording by now
    track = page.locator(".hs-timeline-track")
    box = track.bounding_box()
    assert box is not None
    track.click(position={"x": box["width"] / 2, "y": box["height"] / 2})
    start, end = run.now.playback.start_ns, run.now.playback.end_ns
    assert end is not None
    middle = (start + end) / 2
    arrived = run.until(lambda s: s.playback.state == "paused" and s.playback.time_ns > middle - 0.3e9)
    assert arrived.playback.time_ns == pytest.approx(middle, abs=0.3e9)
    expect(page.locator(".hs-clock b")).to_have_text("00:05.0")


def test_the_speed_is_chosen(run: Run, open_page: Open) -> None:
    """The list at the right of the timeline."""
    page = open_page(run.url)
    choose(page, "bar-transport", "max")
    button(page, "Play").click()
    run.until(lambda s: s.playback.speed == float("inf"))
    run.until(lambda s: s.playback.state == "ended")
    expect(page.locator(".hs-state")).to_have_text("ended")


def test_nothing_covers_the_map(run: Run, open_page: Open) -> None:
    """Canvas, bars and panels lie side by side, and the bars reach across the window."""
    page = open_page(run.url)
    parts = {
        name: page.locator(selector).first.bounding_box()
        for name, selector in {
            "map": "canvas[data-engine]",
            "top": "div:has(> div > .hs-bar-status)",
            "bottom": "div:has(> div > .hs-bar-transport)",
            "panels": "[data-dock-region]",
        }.items()
    }
    assert all(parts.values())
    canvas, top, bottom, panels = parts.values()
    assert top["y"] == 0
    assert top["width"] == bottom["width"] == 1000
    assert canvas["y"] >= top["height"]
    assert canvas["y"] + canvas["height"] <= bottom["y"]
    assert canvas["x"] + canvas["width"] <= panels["x"] + 1


def test_panels_folded_away_leave_the_whole_width_to_the_map(run: Run, open_page: Open) -> None:
    """The bars stay, in this browser alone, and the panels come back."""
    page, other = open_page(run.url), open_page(run.url)
    width = "document.querySelector('canvas[data-engine]').getBoundingClientRect().width"
    button(page, "Panels").click()
    page.wait_for_function(f"{width} === 1000")
    expect(page.locator(".hs-run")).to_be_visible()
    expect(button(page, "Step one scan")).to_be_visible()
    expect(page.locator(".hs-attitude")).to_be_hidden()
    other.wait_for_function(f"{width} < 700")
    button(page, "Panels").click()
    expect(page.locator(".hs-attitude")).to_be_visible()
