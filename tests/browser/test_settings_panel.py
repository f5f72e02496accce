"""The settings of the page, changed by a person's means, on a real engine."""

import pytest
from playwright.sync_api import Page, expect

from hectorscope.inputs import Item
from hectorscope.session.engine import Engine
from hectorscope.web.server import PageServer
from slam_core.config import PRESETS, SlamConfig, leaves, nearest_preset
from tests.browser.conftest import Open
from tests.panels import START, Run, button, choose, open_tab, row
from tests.sources import MemoryStream

pytestmark = pytest.mark.browser

OMEGA = "Weight of the match, ω"


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


@pytest.mark.slow
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
        "OMEGA": {"fusion.omega", "fusion.widen_vertical", "fusion.method"},
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


@pytest.mark.slow
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


@pytest.mark.slow
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
