"""The controls of the page, moved by a person's means, on a real engine."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Locator, Page, expect

from hectorscope.inputs import Item
from hectorscope.run.settings import Settings
from hectorscope.run.warmup import load_everything
from hectorscope.session.commands import Configure, Seek, SetSpeed
from hectorscope.session.engine import Engine
from hectorscope.session.snapshot import Snapshot
from hectorscope.simulation import SceneOptions, Simulation
from hectorscope.web.server import PageServer
from slam_core.config import PRESETS, SlamConfig, leaves, nearest_preset, with_value
from tests.browser.conftest import Open
from tests.engines import until
from tests.sources import MemoryRecording, MemoryStream

pytestmark = pytest.mark.browser

START = Settings(with_value(with_value(SlamConfig(), "map.size", 512), "fusion.omega", 0.1))
PATIENCE_S = 120.0
OMEGA = "Weight of the match, ω"


@dataclass
class Run:
    """An engine and its page."""

    engine: Engine
    url: str

    @property
    def now(self) -> Snapshot:
        """The newest snapshot."""
        snapshot = self.engine.mailbox.latest
        assert snapshot is not None
        return snapshot

    def until(self, holds: Callable[[Snapshot], Any]) -> Snapshot:
        """The first snapshot that `holds`; fails after a while."""
        return until(self.engine, holds, PATIENCE_S)


@pytest.fixture(scope="module")
def drive() -> list[Item]:
    """Ten seconds through the simulated rooms. Kernels are compiled by then, for longer than a test waits."""
    load_everything()
    return list(Simulation("rooms", SceneOptions(duration=10.0, scan_rate=20.0, beams=181)).items())


@pytest.fixture
def run(drive: list[Item], tmp_path: Path) -> Iterator[Run]:
    """The drive, paused at two seconds; results go to the test's own folder."""
    engine = Engine(MemoryRecording(drive), START, autoplay=False, out=tmp_path)
    server = PageServer(engine, port=0)
    server.start()
    engine.start()
    made = Run(engine, server.url)
    try:
        engine.send(Seek(min(item.stamp_ns for item in drive) + 2 * 10**9))
        made.until(lambda s: s.maps and s.playback.state == "paused")
        yield made
    finally:
        engine.stop()
        server.stop()


LET_GO = "document.activeElement === document.body"


def button(page: Page, name: str) -> Locator:
    return page.get_by_role("button", name=name)


def row(page: Page, label: str) -> Locator:
    """A control by its label."""
    return page.locator(".mantine-Flex-root", has=page.locator(f"label:text-is('{label}')"))


def open_tab(page: Page, title: str) -> None:
    page.get_by_role("tab", name=title).click()


def choose(page: Page, container: str, option: str) -> None:
    """An entry of the first list in a container that the style sheet knows."""
    page.locator(f"div:has(> div > .hs-{container}) .mantine-Select-input").first.click()
    page.locator("[role=option]:visible", has_text=option).click()


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
    run.until(lambda s: s.scans > there.scans + 50 and s.playback.state == "paused")
    page = open_page(run.url)
    open_tab(page, "Log")
    entry = page.locator(".hs-log-list li", has_text="fusion.omega: 0.1 → 0.3")
    expect(entry.locator("small")).to_have_text(f"scan {there.scans}")
    entry.get_by_role("button").click()
    back = run.until(lambda s: s.epoch > there.epoch and s.playback.state == "paused")
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


def test_omega_changes_the_fused_ellipse(run: Run, open_page: Open) -> None:
    """Moved while paused, it is in force for the next scan, whose fused covariance it shrinks or grows."""
    page, before = open_page(run.url), run.now
    open_tab(page, "Settings")
    slider = row(page, OMEGA).get_by_role("slider")
    slider.focus()
    slider.press("End")
    run.until(lambda s: s.config.fusion.omega == 0.999)
    button(page, "Step one scan").click()
    after = run.until(lambda s: s.scans > before.scans)
    assert before.result is not None
    assert after.result is not None
    ratio = after.result.fused.covariance[0, 0] / before.result.fused.covariance[0, 0]
    assert not 0.8 < ratio < 1.25
    open_tab(page, "Log")
    expect(page.locator(".hs-log-list")).to_contain_text("fusion.omega: 0.1 → 0.999")


def test_a_preset_sets_all_its_settings_at_once(run: Run, open_page: Open) -> None:
    """One line of the log for all of them; what is changed after that is named as differing from it."""
    page = open_page(run.url)
    open_tab(page, "Settings")
    choose(page, "settings", "paper")
    paper = run.until(lambda s: nearest_preset(s.config)[0] == "paper")
    line = f"preset paper: {len(PRESETS['paper'])} settings changed"
    assert [entry.text for entry in paper.log].count(line) == 1
    box = row(page, "Deskew").get_by_role("checkbox")
    expect(box).not_to_be_checked()  # the preset has reached this browser
    box.click()
    expect(page.locator(".hs-differs")).to_contain_text("Differs from paper in 3")
    expect(page.locator(".hs-differs li").first).to_contain_text("Deskew on (off)")
    expect(row(page, "Preset").locator("input").first).to_have_value("paper")


def shown(page: Page) -> list[str]:
    """The names of the settings whose controls are to be seen, from top to bottom."""
    script = """settings => settings.flatMap(setting => {
        let control = setting.parentElement.nextElementSibling
        if (control.querySelector(".hs-log")) control = control.nextElementSibling
        return control.checkVisibility() ? [setting.dataset.hsWords.split(" ")[0]] : []
    })"""
    names: list[str] = page.locator(".hs-setting").evaluate_all(script)
    return names


def test_the_page_opens_on_few_settings_and_finds_any(run: Run, open_page: Open) -> None:
    """At most twenty, the thresholds, sigma and omega first. Each browser finds others by name, label or help."""
    one, two = open_page(run.url), open_page(run.url)
    for page in (one, two):
        open_tab(page, "Settings")
        expect(row(page, OMEGA)).to_be_visible()
    basic = {leaf.name for leaf in leaves(SlamConfig()) if leaf.param.tier != "expert"}
    assert set(shown(one)) == basic
    assert shown(one)[:4] == ["map.update_distance", "map.update_angle", "matcher.sigma", "fusion.omega"]
    labels = one.locator("div:has(> div > .hs-settings) .mantine-Flex-root:has(label)").filter(visible=True)
    assert labels.count() <= 20
    one.get_by_role("checkbox", name="expert").click()
    assert set(shown(one)) == {leaf.name for leaf in leaves(SlamConfig())}
    assert set(shown(two)) == basic
    before, find = run.now, two.get_by_role("searchbox", name="Find a setting")
    find.press_sequentially("range max [ ]")  # keys that restart, play and change the speed elsewhere
    find.fill("range max")
    expect(two.locator(".hs-find output")).to_have_text("1 found")
    assert (run.now.epoch, run.now.playback) == (before.epoch, before.playback)
    find.fill("")
    two.get_by_text("Fusion · V-B").click()  # folds it
    for words, found in {
        "gravity magn": {"navigation.gravity"},
        "OMEGA": {"fusion.omega", "fusion.widen_vertical", "fusion.method", "motion.observed_only"},
        "gate of the match": {"fusion.gate"},
        'no "such] setting': set(),
    }.items():
        find.fill(words)
        expect(two.locator(".hs-find output")).to_have_text(f"{len(found)} found")
        assert set(shown(two)) == found


def test_a_threshold_changes_the_number_of_map_updates(run: Run, open_page: Open) -> None:
    """With a distance of 5 m between updates, for the whole run, the same drive updates the map less often."""
    page = open_page(run.url)
    choose(page, "bar-transport", "max")
    button(page, "Play").click()
    often = run.until(lambda s: s.playback.state == "ended")
    open_tab(page, "Settings")
    row(page, "Changes act").locator(".mantine-Select-input").click()
    page.locator("[role=option]:visible", has_text="for the whole run").click()
    for label, value in (("Update distance (m)", "5"), ("Update angle (rad)", "3")):
        row(page, label).get_by_role("textbox").fill(value)
    run.until(lambda s: s.config.map.update_distance == 5.0 and s.config.map.update_angle == 3.0)
    rarely = run.until(lambda s: s.playback.state == "ended" and s.map_updates < often.map_updates)
    assert rarely.map_updates >= 1
    assert rarely.scans == often.scans


def test_browsers_agree_and_changes_are_marked_and_reset(run: Run, open_page: Open) -> None:
    """What one person sets another sees, also who comes later; one click resets a setting, another all of them."""
    one, two = open_page(run.url), open_page(run.url)
    for page in (one, two):
        open_tab(page, "Settings")
    row(one, OMEGA).get_by_role("textbox").fill("0.7")
    expect(row(two, OMEGA).get_by_role("textbox")).to_have_value("0.7")
    three = open_page(run.url)
    open_tab(three, "Settings")
    expect(row(three, OMEGA).get_by_role("textbox")).to_have_value("0.7")
    differing = ["↺Size 512 (1024)", f"↺{OMEGA} 0.7 (0.02)"]
    for page in (one, two, three):
        expect(page.locator(".hs-differs li")).to_have_text(differing)
        expect(page.locator(".hs-changed button:visible")).to_have_count(1)  # the other one is for experts
    button(two, "As started").click()
    run.until(lambda s: s.config == START.start)
    one.locator(".hs-changed").get_by_role("button", name="Reset fusion.omega to 0.02").click()
    expect(row(three, OMEGA).get_by_role("textbox")).to_have_value("0.02")
    button(two, "Reset all").click()
    run.until(lambda s: s.config == SlamConfig())
    for page in (one, two, three):
        expect(page.locator(".hs-differs li, .hs-changed")).to_have_count(0)


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


def test_a_stream_keeps_its_map_until_somebody_agrees(drive: list[Item], open_page: Open) -> None:
    """A setting that needs a new map asks first, and keeping the map puts the control back."""
    stream = MemoryStream()
    engine = Engine(stream, START)
    server = PageServer(engine, port=0)
    server.start()
    engine.start()
    run = Run(engine, server.url)
    try:
        stream.send(drive[: len(drive) // 5])
        begun = run.until(lambda s: s.maps)
        page = open_page(run.url)
        open_tab(page, "Settings")
        levels = row(page, "Levels").get_by_role("textbox")
        levels.fill("2")
        button(page, "Keep the map").click()
        expect(levels).to_have_value("3")
        assert run.now.epoch == begun.epoch
        levels.fill("2")
        button(page, "Begin a new map").click()
        run.until(lambda s: s.epoch > begun.epoch and s.config.map.levels == 2)
    finally:
        engine.stop()
        server.stop()
