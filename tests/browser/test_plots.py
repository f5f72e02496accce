"""The plots, as a person reads them."""

import time
from dataclasses import replace

import numpy as np
import pytest
from playwright.sync_api import Page, expect

from hectorscope.run.series import SERIES_DTYPE
from hectorscope.session.commands import Seek
from hectorscope.session.snapshot import PlaybackStatus, Snapshot
from tests.browser.conftest import Open, Show
from tests.page import room_snapshot, with_series

pytestmark = pytest.mark.browser

DESK = {"width": 1280, "height": 800}
ROWS, END_S = 400, 60.0
EVERY = ["Covariance", "Match", "Error against truth", "Attitude", "Biases", "Motion", "Time spent"]
FIGURE = ".hs-plots figure:visible"
PATIENCE_S = 60.0
DARK = "rgba(0, 0, 0, 0)"
# Of our own values only: viser's parts look at the page too, whenever they like.
COUNT_LOOKS = """() => {
  const styles = CSSStyleDeclaration.prototype, look = styles.getPropertyValue;
  window.read = 0;
  styles.getPropertyValue = function (name) {
    window.read += name.startsWith("--hs-");
    return look.call(this, name);
  };
}"""
PICTURES = "[...document.querySelectorAll('.hs-plots figure:not([hidden]) canvas')].map((e) => e.toDataURL())"
BESIDE = np.array([0, 0, 0.1, 0, 0, 0, 0, 0])  # metres, as the truth lies
BOXES = "() => [...document.querySelectorAll('.hs-canvas')].map((e) => JSON.stringify(e.getBoundingClientRect()))"


# The element that describes the charts is another one, and the rows that the page asks for then are marked.
NEW_CONNECTION = """() => {
  const { rows, plotted } = window.hectorscope, mark = document.querySelector('[data-hs-charts]');
  window.hectorscope.rows = (...added) => {
    rows(...added);
    plotted().tables[added[0]].asked = true;
  };
  mark.replaceWith(mark.cloneNode());
}"""
DRAWN = """() => new Promise((drawn) => {
  window.hectorscope.own.set('theme', 'light');
  requestAnimationFrame(() => requestAnimationFrame(drawn));
})"""


def driven() -> Snapshot:
    """Forty seconds of a recording of sixty, with figures in every column and a truth."""
    series = np.zeros(ROWS, SERIES_DTYPE)
    for i, name in enumerate(SERIES_DTYPE.names or ()):
        series[name] = 0.01 * (i + 1) * (2.0 + np.sin(0.05 * np.arange(ROWS) + i))
    series["time_s"] = 0.1 * np.arange(1, ROWS + 1)
    path = np.zeros((ROWS, 8))
    path[:, 0], path[:, 1], path[:, 4] = series["time_s"], np.linspace(-6.0, 0.0, ROWS), 1.0
    playback = PlaybackStatus(state="paused", time_ns=40 * 10**9, end_ns=round(END_S * 1e9))
    shown = replace(room_snapshot(), trajectory=path, truth=path + BESIDE, playback=playback)
    return with_series(shown, series)


def opened(show: Show, open_page: Open, **own: object) -> Page:
    """The page on a desk, once the charts are drawn."""
    show.engine.show(driven())
    page = open_page(show.url, size=DESK, own={"plots": "below", **own})
    page.wait_for_function(f"window.hectorscope.plotted().tables.series?.count === {ROWS}")
    expect(page.locator(FIGURE).first).to_be_visible()
    return page


def inside(page: Page) -> int:
    """How many charts lie in the window as a whole."""
    count: int = page.evaluate("""() => [...document.querySelectorAll('.hs-plots figure')].filter((e) => {
      const box = e.getBoundingClientRect(), room = document.querySelector('.hs-charts').getBoundingClientRect();
      const across = box.left >= room.left && box.right <= room.right + 1;
      return box.width > 100 && across && box.bottom <= room.bottom + 1;
    }).length""")
    return count


def test_new_rows_are_drawn_without_a_look_at_the_style_sheet(show: Show, open_page: Open) -> None:
    """Colours are known from before: to read them lays the page out anew, for each curve of each chart.

    They are read by the first drawing, and by the one after a setting of the page, which may come late.
    """
    page = opened(show, open_page)
    more, looks = driven(), list[int]()
    page.evaluate(COUNT_LOOKS)
    for sequence in range(2, 7):
        page.evaluate("window.read = 0")
        before = page.evaluate(PICTURES)
        show.engine.show(replace(more, sequence=sequence, series=more.series[: ROWS // sequence]))
        page.wait_for_function(f"(before) => ({PICTURES}).every((each, i) => each !== before[i])", arg=before)
        looks.append(page.evaluate("window.read"))
    assert looks[-1] == 0 or looks[-2] == 0


def test_the_tab_of_charts_without_data_is_not_lit(show: Show, open_page: Open) -> None:
    """As of the error on a recording without truth; it stays chosen for the next one."""
    show.engine.show(replace(driven(), truth=np.empty((0, 8))))
    page = open_page(show.url, size=DESK, own={"plots": "below"})
    expect(page.locator(FIGURE).first).to_be_visible()
    tab = page.locator(".hs-pages button", has_text="Error against truth")
    expect(tab).to_have_css("background-color", DARK)
    expect(tab).to_have_attribute("aria-pressed", "true")
    lit = opened(show, open_page).locator(".hs-pages button", has_text="Error against truth")
    expect(lit).not_to_have_css("background-color", DARK)


def test_tabs_stay_lit_with_a_new_connection(show: Show, open_page: Open) -> None:
    """It brings the description of the charts once more, in an element of its own."""
    page = opened(show, open_page)
    tabs = page.locator(".hs-pages button:not(.hs-bare)")
    expect(tabs).not_to_have_count(0)
    lit = tabs.all_inner_texts()
    page.evaluate(NEW_CONNECTION)
    page.wait_for_function("window.hectorscope.plotted().tables.series.asked")
    page.evaluate(DRAWN)
    assert tabs.all_inner_texts() == lit


def test_charts_lie_side_by_side_below_the_scene(show: Show, open_page: Open) -> None:
    """Five at once on a desk, below the scene and the panels, and none is cut off."""
    page = opened(show, open_page)
    titles = page.locator(f"{FIGURE} b")
    expect(titles).to_have_text(["σ x, mm", "σ y, mm", "σ ψ, °", "Position in the plane, mm", "Heading, °"])
    assert inside(page) == 5
    tops = page.evaluate(
        "[...document.querySelectorAll('.hs-plots figure:not([hidden])')].map((e) => e.offsetTop)"
    )
    assert len(set(tops)) == 1
    bottom = page.evaluate("document.querySelector('canvas[data-engine]').getBoundingClientRect().bottom")
    assert bottom <= page.evaluate("document.querySelector('.hs-plots').getBoundingClientRect().top")


@pytest.mark.slow
def test_charts_fill_the_window_and_go_away(show: Show, open_page: Open) -> None:
    """All of them over the whole window, in several columns, and none at all; each browser has its own."""
    page, other = opened(show, open_page, pages=EVERY), opened(show, open_page)
    page.keyboard.press("x")
    expect(page.locator("html")).to_have_attribute("data-hs-plots", "full")
    expect(page.locator(FIGURE)).to_have_count(19)
    page.wait_for_function("document.querySelector('.hs-plots').getBoundingClientRect().height > 620")
    assert inside(page) >= 9
    page.keyboard.press("g")
    expect(page.locator(".hs-plots")).to_be_hidden()
    expect(other.locator(".hs-plots")).to_be_visible()
    expect(other.locator(FIGURE)).to_have_count(5)
    other.get_by_role("button", name="Attitude").click()
    expect(other.locator(f"{FIGURE} b", has_text="Roll and pitch")).to_be_visible()
    other.reload()
    expect(other.locator(f"{FIGURE} b", has_text="Roll and pitch")).to_be_visible()


def test_one_cursor_is_in_every_chart_and_on_the_timeline(show: Show, open_page: Open) -> None:
    """At the time under the pointer, with the values there; nothing moves as it comes and goes."""
    page = opened(show, open_page, window=1e9)
    before = page.evaluate(BOXES)
    box = page.locator(".hs-canvas canvas").first.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 0.5 * box["height"])
    expect(page.locator(".hs-cursor:visible")).to_have_count(5)
    at = page.evaluate("window.hectorscope.plotted().at")
    assert 15.0 < at < 30.0
    row = int(at / 0.1) - 1
    shown = float(page.locator(f"{FIGURE} output").first.inner_text())
    assert shown == pytest.approx(1e3 * driven().series["match_sigma_x"][row], rel=0.02)
    track = page.locator(".hs-timeline-track").bounding_box()
    marker = page.locator(".hs-timeline-cursor").bounding_box()
    assert track is not None and marker is not None
    assert marker["x"] + 0.5 == pytest.approx(track["x"] + at / END_S * track["width"], abs=2.0)
    assert page.evaluate(BOXES) == before
    page.mouse.move(track["x"] + 0.5 * track["width"], track["y"] + 0.5 * track["height"])
    page.wait_for_function(f"Math.abs(window.hectorscope.plotted().at - {END_S / 2}) < 0.2")
    expect(page.locator(".hs-cursor:visible")).to_have_count(5)
    page.mouse.move(300, 200)
    expect(page.locator(".hs-cursor:visible")).to_have_count(0)
    assert page.evaluate(BOXES) == before


def test_a_click_on_a_chart_goes_there(show: Show, open_page: Open) -> None:
    """The run is sent to the time under the pointer."""
    page = opened(show, open_page, window=1e9)
    canvas = page.locator(".hs-canvas canvas").nth(1)
    box = canvas.bounding_box()
    assert box is not None
    canvas.click(position={"x": 0.5 * box["width"], "y": 0.5 * box["height"]})
    at = page.evaluate("window.hectorscope.plotted().at")
    ends = time.monotonic() + PATIENCE_S
    while not show.engine.sent and time.monotonic() < ends:
        page.evaluate("0")
    (command,) = show.engine.sent
    assert isinstance(command, Seek)
    assert command.time_ns == pytest.approx(at * 1e9, abs=0.2e9)


def test_a_run_begun_again_has_new_curves(show: Show, open_page: Open) -> None:
    """Rows of the run before are gone, and rows that come later are added."""
    page = opened(show, open_page)
    again = replace(driven(), sequence=2, epoch=1)
    count = "window.hectorscope.plotted().tables.series.count"
    for rows in (20, 35):
        show.engine.show(with_series(replace(again, sequence=rows), again.series[:rows], lineage=1))
        page.wait_for_function(f"{count} === {rows}")


def test_the_wheel_magnifies_all_charts_together(show: Show, open_page: Open) -> None:
    """About the time under the pointer, which a click then seeks; turned back, the window is whole again."""
    page = opened(show, open_page, window=1e9)
    whole = page.evaluate("window.hectorscope.plotted().span")
    canvas = page.locator(".hs-canvas canvas").nth(2)
    box = canvas.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    at = page.evaluate("window.hectorscope.plotted().at")
    page.mouse.wheel(0, -500)
    page.wait_for_function(
        "([a, b]) => (([c, d]) => d - c < 0.5 * (b - a))(window.hectorscope.plotted().span)", arg=whole
    )
    low, high = page.evaluate("window.hectorscope.plotted().span")
    assert low < at < high
    assert page.evaluate("window.hectorscope.plotted().at") == pytest.approx(at, abs=0.2)
    page.mouse.wheel(0, 2000)
    page.wait_for_function("(s) => String(window.hectorscope.plotted().span) === String(s)", arg=whole)


def test_an_entry_of_a_chart_hides_its_curve(show: Show, open_page: Open) -> None:
    """In this browser, also when the page is opened again; the axis then fits what is left."""
    page = opened(show, open_page)
    entry = page.locator(f"{FIGURE} .hs-entry", has_text="prior").first
    entry.click()
    expect(entry).to_have_attribute("aria-pressed", "false")
    page.reload()
    page.wait_for_function("window.hectorscope?.plotted().tables.series?.count > 0")
    expect(page.locator(f"{FIGURE} .hs-entry", has_text="prior").first).to_have_attribute("aria-pressed", "false")
    expect(page.locator(f"{FIGURE} .hs-entry", has_text="match").first).to_have_attribute("aria-pressed", "true")
