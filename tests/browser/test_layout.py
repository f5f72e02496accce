"""The page on small screens and on a projector, and what each browser keeps for itself."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Locator, Page, ViewportSize, expect

from hectorscope.run.map_image import MapImage
from tests.browser.conftest import READY, Open, Show
from tests.cases import quick_first
from tests.page import RESOLUTION, room_maps, room_snapshot
from tests.scene import PROJECT, RESTS, choose_own, look, node

pytestmark = pytest.mark.browser

PHONES_AND_TABLETS: dict[str, ViewportSize] = {
    "phone": {"width": 390, "height": 844},
    "tall tablet": {"width": 768, "height": 1024},
    "wide tablet": {"width": 1024, "height": 768},
}
SIZES = pytest.mark.parametrize("size", quick_first(PHONES_AND_TABLETS.values(), ids=PHONES_AND_TABLETS))
TABS = ("Live", "Filter", "Settings", "Display", "Runs", "Log")
ALWAYS = (".hs-state", ".hs-clock", ".hs-losses", ".hs-tools", "button:has-text('Play')")
# Elements of the open tab that reach beyond the window, or hide some of their text.
CUT = """() => [...document.querySelectorAll('.hs-attitude, .hs-pose, .hs-readout, .hs-sigmas, .hs-legend,'
  + '.hs-fusion, .hs-sources, .hs-biases, .hs-find, .hs-own-row, .hs-own-box, .hs-figure, [role=tab],'
  + '.mantine-Slider-root')]
  .filter((e) => e.checkVisibility()).filter((e) => {
    const box = e.getBoundingClientRect();
    const outside = box.left < -1 || box.right > innerWidth + 1; // a slider's thumb may stand out of its track
    const inside = !e.matches('.mantine-Slider-root, [role=tab]') && e.clientWidth > 0;
    return outside || inside && e.scrollWidth > e.clientWidth + 2;
  }).map((e) => e.className + ' ' + e.textContent.slice(0, 30))"""


# The scene ends where the panels begin.
BESIDE = """() => {
  const [scene, panels] = ['canvas[data-engine]', '[data-dock-region]'].map(
    (name) => document.querySelector(name).getBoundingClientRect());
  return scene.right <= panels.left + 1;
}"""

# Once the scene has kept its size for half a second.
STANDS = """new Promise((stands) => {
  let [seen, since] = ['', performance.now()];
  const look = () => {
    const { width, height } = document.querySelector('canvas[data-engine]').getBoundingClientRect();
    if (seen !== `${width} ${height}`) [seen, since] = [`${width} ${height}`, performance.now()];
    if (performance.now() - since > 500) stands(); else requestAnimationFrame(look);
  };
  look();
})"""


def box_of(found: Locator) -> dict[str, float]:
    """Where an element is in the window."""
    box = found.first.bounding_box()
    assert box is not None
    return dict(box)


def button(page: Page, name: str) -> Locator:
    return page.get_by_role("button", name=name)


@SIZES
def test_small_screens_have_the_scene_on_top_and_the_state_in_sight(
    show: Show, open_page: Open, size: ViewportSize
) -> None:
    """Whatever tab is open, and with the panels as a sheet that folds; nothing is cut off."""
    page = open_page(show.url, size=size)
    scene = box_of(page.locator("canvas[data-engine]"))
    assert scene["y"] < 90 and scene["height"] > 0.3 * size["height"] and scene["width"] > 0.6 * size["width"]
    for tab in TABS:
        page.get_by_role("tab", name=tab).click()
        for part in ALWAYS:
            box = box_of(page.locator(f"{part} >> visible=true"))
            assert box["x"] >= 0 and box["x"] + box["width"] <= size["width"], part
            assert box["y"] >= 0 and box["y"] + box["height"] <= size["height"], part
        assert page.evaluate(CUT) == [], tab
    track = box_of(page.locator(".hs-timeline-track"))
    assert track["width"] > 0.3 * size["width"] and track["y"] + track["height"] <= size["height"]


@pytest.mark.parametrize("width", [320, 360])
def test_nothing_lies_over_anything_else_on_a_small_phone(show: Show, open_page: Open, width: int) -> None:
    """The figures of the bar stand above the scene, the clock beside the buttons."""
    page = open_page(show.url, size={"width": width, "height": 640})
    losses = box_of(page.locator(".hs-losses >> visible=true"))
    assert losses["y"] + losses["height"] <= box_of(page.locator("canvas[data-engine]"))["y"] + 1
    clock = box_of(page.locator(".hs-clock b >> visible=true"))
    on_buttons = f"""document.elementsFromPoint({clock["x"] + 1}, {clock["y"] + clock["height"] / 2})
      .some((e) => e.closest("button"))"""
    assert not page.evaluate(on_buttons)


@pytest.mark.parametrize("size", quick_first([{"width": 740, "height": 360}, {"width": 640, "height": 320}]))
def test_a_phone_held_sideways_has_the_panel_beside_the_scene(
    show: Show, open_page: Open, size: ViewportSize
) -> None:
    """One row above and one below; the panel folds and leaves the whole width to the scene."""
    page = open_page(show.url, size=size)
    scene = box_of(page.locator("canvas[data-engine]"))
    live = box_of(page.get_by_role("tab", name="Live"))
    assert scene["height"] > 0.65 * size["height"] and scene["width"] > 0.4 * size["width"]
    assert live["x"] >= scene["x"] + scene["width"] - 1
    for part in (".hs-state", ".hs-clock b", ".hs-timeline-track"):
        box = box_of(page.locator(f"{part} >> visible=true"))
        assert box["x"] >= 0 and box["x"] + box["width"] <= size["width"], part
        assert box["y"] >= 0 and box["y"] + box["height"] <= size["height"], part
    page.locator(".hs-handle").click()
    wide = "document.querySelector('canvas[data-engine]').getBoundingClientRect().width"
    page.wait_for_function(f"{wide} > {size['width']} - 2")
    page.locator(".hs-handle").click()
    page.wait_for_function(f"{wide} < {size['width']} - 300")


@pytest.mark.parametrize("name", quick_first(["phone", "tall tablet"]))
def test_the_sheet_folds(show: Show, open_page: Open, name: str) -> None:
    """A click on its handle leaves the tabs alone and gives the room to the scene; another brings it back."""
    page = open_page(show.url, size=PHONES_AND_TABLETS[name])
    height = "document.querySelector('canvas[data-engine]').getBoundingClientRect().height"
    page.evaluate(STANDS)
    before = page.evaluate(height)
    sheet = box_of(page.get_by_role("tab", name="Live"))
    scene = box_of(page.locator("canvas[data-engine]"))
    assert scene["y"] + scene["height"] <= sheet["y"]
    page.locator(".hs-handle").click()
    page.wait_for_function(f"{height} > {before} + 150")
    expect(page.get_by_role("tab", name="Live")).to_be_in_viewport()
    page.locator(".hs-handle").click()
    page.wait_for_function(f"Math.abs({height} - {before}) < 2")


@pytest.mark.slow
def test_each_browser_has_its_own_theme_layout_and_layers(show: Show, open_page: Open) -> None:
    """They are kept in the browser, and nobody else sees them."""
    one, two = open_page(show.url), open_page(show.url)
    button(one, "Light theme").click()
    one.get_by_role("tab", name="Display").click()
    one.get_by_label("Map", exact=True).select_option("one")
    one.get_by_label("Level", exact=True).select_option("1")
    one.get_by_role("checkbox", name="Robot").uncheck()
    for _ in ("as chosen", "after opening the page again"):
        expect(one.locator("html")).to_have_attribute("data-mantine-color-scheme", "light")
        one.wait_for_function("!window.__viserMutable.nodeRefFromName['/floor/map/level0']?.visible")
        one.wait_for_function("window.__viserMutable.nodeRefFromName['/floor/map/level1']?.visible")
        one.wait_for_function("window.__viserMutable.nodeRefFromName['/robot']?.visible === false")
        one.reload()
        one.wait_for_function(READY)
    expect(two.locator("html")).to_have_attribute("data-mantine-color-scheme", "dark")
    assert [node(two, name)["visible"] for name in ("/floor/map/level0", "/robot")] == [True, True]  # type: ignore[index]


def test_each_browser_keeps_its_camera(show: Show, open_page: Open) -> None:
    """Opened again, the page looks from where it looked."""
    page = open_page(show.url)
    look(page, "free")
    page.evaluate("window.__viserMutable.cameraControl.setLookAt(-3, 9, 4, 1, 0, 2, false)")
    page.wait_for_function("window.hectorscope.own.get('camera')?.pose?.[1] === 9")
    page.reload()
    page.wait_for_function("window.__viserMutable?.cameraControl && window.hectorscope.levels().places.length")
    page.wait_for_function("Math.abs(window.__viserMutable.cameraControl.getPosition().y - 9) < 1e-3")
    page.wait_for_function(RESTS)
    assert page.evaluate("window.__viserMutable.cameraControl.getPosition().x") == pytest.approx(-3.0, abs=1e-3)


@pytest.mark.parametrize(
    "kept",
    quick_first(
        ['{"theme": "pink", "gap": "wide", "camera": {"pose": [null]}, "evil": 1}', "nonsense", "[1]", "null"], 2
    ),
)
def test_what_a_browser_kept_of_another_version_does_no_harm(show: Show, open_page: Open, kept: str) -> None:
    """What does not fit is as if it had never been chosen."""
    page = open_page(show.url, before=f"localStorage.setItem('hectorscope', {json.dumps(kept)})")
    chosen = page.evaluate("['theme', 'gap', 'layout', 'plots'].map(window.hectorscope.own.get)")
    assert chosen == ["dark", 0.5, "stacked", "below"]


def test_the_page_says_what_is_shared(again: Open) -> None:
    """The run and the settings belong to all browsers, camera and layers to this one."""
    page = again()
    content = "getComputedStyle(document.querySelector('div:has(> div > .hs-bar-transport)'), '::after').content"
    assert "shared by every browser" in page.evaluate(content)
    page.get_by_role("tab", name="Settings").click()
    expect(page.locator(".hs-scope:visible")).to_have_text(["Shared by every browser"])
    page.get_by_role("tab", name="Display").click()
    expect(page.locator(".hs-scope:visible")).to_have_text(["This browser only", "Shared by every browser"])


@pytest.mark.parametrize("size", quick_first([{"width": 1280, "height": 800}, {"width": 1920, "height": 1080}]))
def test_a_presentation_has_large_type(show: Show, open_page: Open, size: ViewportSize) -> None:
    """Everything that is read grows by four tenths, and still nothing lies over anything else."""
    page = open_page(show.url, size=size, own={})
    parts = (".hs-state", ".hs-clock b", ".hs-sigmas", ".hs-names span", ".hs-pages button")
    before = {part: box_of(page.locator(part))["height"] for part in parts}
    page.keyboard.press("p")
    for part in parts:
        page.wait_for_function(
            "([part, height]) => document.querySelector(part).getBoundingClientRect().height > 1.3 * height",
            arg=[part, before[part]],
        )
    page.wait_for_function(f"({CUT})().length === 0")
    page.wait_for_function(BESIDE)
    run, losses = box_of(page.locator(".hs-run")), box_of(page.locator(".hs-losses"))
    assert run["x"] + run["width"] <= losses["x"] + 1


def test_a_question_mark_shows_the_keys(again: Open) -> None:
    """And takes them away; where something is typed it is a letter, and no key acts."""
    page = again()
    page.keyboard.press("?")
    expect(page.get_by_role("dialog", name="Keys")).to_be_visible()
    expect(page.locator(".hs-keys dt").first).to_have_text("space")
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog", name="Keys")).to_be_hidden()
    button(page, "Keys").click()
    expect(page.get_by_role("dialog", name="Keys")).to_be_visible()
    page.keyboard.press("?")
    page.get_by_role("tab", name="Settings").click()
    page.get_by_role("searchbox").press_sequentially("t?p")
    expect(page.locator("html")).to_have_attribute("data-mantine-color-scheme", "dark")
    expect(page.get_by_role("dialog", name="Keys")).to_be_hidden()


def test_full_screen(again: Open) -> None:
    """The button and the key F."""
    page = again()
    button(page, "Full screen").click()
    page.wait_for_function("document.fullscreenElement === document.documentElement")
    page.keyboard.press("f")
    page.wait_for_function("document.fullscreenElement === null")


def five_levels() -> tuple[MapImage, ...]:
    """The room in five levels."""
    finest = room_maps()[0]
    return tuple(
        replace(finest, level=i, resolution=RESOLUTION * 2**i, cells=finest.cells[:: 2**i, :: 2**i].copy())
        for i in range(5)
    )


@pytest.mark.parametrize("size", quick_first([{"width": 1280, "height": 800}, {"width": 768, "height": 1024}]))
def test_five_levels_side_by_side_use_the_screen(show: Show, open_page: Open, size: ViewportSize) -> None:
    """All are in the window, none over another, and together they fill it in one direction."""
    show.engine.show(replace(room_snapshot(2), maps=five_levels()))
    page = open_page(show.url, size=size)
    page.wait_for_function("window.hectorscope.levels().places.length === 5")
    choose_own(page, layout="side")
    page.wait_for_function(
        "window.hectorscope.levels().places[4].x + window.hectorscope.levels().places[4].y !== 0"
    )
    page.wait_for_timeout(100)
    page.wait_for_function(RESTS)
    canvas = box_of(page.locator("canvas[data-engine]"))
    boxes = []
    for i in range(5):
        x, y, z = node(page, f"/floor/map/level{i}")["position"]  # type: ignore[index]
        corners = [page.evaluate(PROJECT, [x + dx, y + dy, z]) for dx in (-8, 8) for dy in (-6, 6)]
        low, high = np.min(corners, axis=0), np.max(corners, axis=0)
        assert low[0] >= canvas["x"] and high[0] <= canvas["x"] + canvas["width"]
        assert low[1] >= canvas["y"] and high[1] <= canvas["y"] + canvas["height"]
        boxes.append((low, high))
    for i, (low, high) in enumerate(boxes):
        for other_low, other_high in boxes[:i]:
            assert np.any((low >= other_high - 1) | (other_low >= high - 1))
    span = np.max([high for _, high in boxes], axis=0) - np.min([low for low, _ in boxes], axis=0)
    assert max(span / [canvas["width"], canvas["height"]]) > 0.85


def names(page: Page) -> list[str]:
    """The names of levels that are to be seen."""
    found: list[str] = page.locator(".hs-names span:visible").all_inner_texts()
    return found


def test_names_belong_to_the_levels_that_are_seen(again: Open) -> None:
    """In a stack and from above, alone, and not at all; in the colours of the theme."""
    page = again()
    every = ["level 0 · 25 cm", "level 1 · 50 cm", "level 2 · 100 cm"]
    expect(page.locator(".hs-names span:visible")).to_have_text(every)
    colour = "getComputedStyle(document.querySelector('.hs-names span')).color"
    dark = page.evaluate(colour)
    choose_own(page, theme="light")
    page.wait_for_function(f"{colour} !== '{dark}'")
    look(page, "top")
    expect(page.locator(".hs-names span:visible")).to_have_text(every[:1])
    choose_own(page, layout="one", level=2)
    expect(page.locator(".hs-names span:visible")).to_have_text(every[2:])
    choose_own(page, layers={"names": False})
    expect(page.locator(".hs-names span:visible")).to_have_count(0)


def test_a_layer_on_demand_is_sent_once_a_browser_shows_it(show: Show, again: Open) -> None:
    """Until then the server sends nothing of it."""
    page = again()
    assert not show.server.scene.display.asked
    page.get_by_role("tab", name="Display").click()
    page.get_by_role("checkbox", name="Surfels").check()
    asked: Any = frozenset()
    while not asked:
        page.evaluate("0")
        asked = show.server.scene.display.asked
    assert asked == {"surfels"}


def test_the_tabs_stand_in_one_row(show: Show, open_page: Open) -> None:
    """On a desk, all of them."""
    page = open_page(show.url, size={"width": 1280, "height": 800})
    tops = page.locator("[role=tab]").evaluate_all("(tabs) => tabs.map((tab) => tab.getBoundingClientRect().top)")
    assert len(tops) >= 6
    assert len(set(tops)) == 1
