"""A closer look at a real run: beams and cells that are clicked, distances, entries of the legend."""

import pytest
from playwright.sync_api import Page, expect

from hectorscope.session.commands import Seek, StepBack
from hectorscope.session.engine import Engine
from slam_core.geometry import transform_points
from slam_core.results import StepResult
from tests.browser.conftest import Open
from tests.engines import after, until
from tests.scene import PROJECT, choose_own, look

pytestmark = pytest.mark.browser
BEAMS = 181
CARD = ".hs-closer"


def shown(engine: Engine) -> StepResult:
    """The scan eleven seconds after the start, where the run then rests."""
    latest = engine.mailbox.latest
    assert latest is not None
    result = after(engine, Seek(latest.playback.start_ns + 11_000_000_000)).result
    assert result is not None
    return result


def seen_from_above(opened: Open, url: str) -> Page:
    page = opened(url)
    choose_own(page, layout="one")
    look(page, "top")
    return page


def click(page: Page, x: float, y: float) -> None:
    """A click at a place of the map."""
    column, row = page.evaluate(PROJECT, [x, y, 0.0])
    page.mouse.click(column, row)


def test_a_click_on_a_beam_shows_its_figures_for_each_shown_scan(
    engine: Engine, url: str, kept: Open, open_page: Open
) -> None:
    """Range and residual of that beam; another scan has other figures; Escape closes; others see nothing."""
    result = shown(engine)
    page, other = seen_from_above(kept, url), seen_from_above(open_page, url)
    ends = transform_points(result.planar, result.points)
    assert result.sweep is not None
    click(page, *ends[60].tolist())
    card = page.locator(CARD)
    expect(card).to_contain_text("residual in the match")
    number = int(page.locator("[data-hs-number]").get_attribute("data-hs-number") or "")
    expect(card).to_contain_text(f"{result.sweep.scan.ranges[number]:.3f} m")
    expect(page.locator(".hs-marks .hs-mark-beam")).to_have_count(1)
    expect(other.locator(CARD)).to_be_hidden()
    before = after(engine, StepBack()).result
    assert before is not None
    assert before.sweep is not None
    expect(card).to_contain_text(f"{before.sweep.scan.ranges[number]:.3f} m")
    page.get_by_label("Next beam").click()
    expect(page.locator("[data-hs-number]")).to_have_attribute("data-hs-number", str(number + 1))
    page.keyboard.press("Escape")
    expect(card).to_be_hidden()
    until(engine, lambda now: not now.views)


def test_a_click_on_a_cell_shows_its_probabilities_and_times(engine: Engine, url: str, kept: Open) -> None:
    """Of every level, and when it was written; a place that is not known closes the card."""
    result = shown(engine)
    page = seen_from_above(kept, url)
    click(page, float(result.planar[0]) + 0.3, float(result.planar[1]))
    card = page.locator(CARD)
    expect(card).to_contain_text("written first")
    expect(card.locator(".hs-levels tr")).to_have_count(1 + engine.mailbox.latest.config.map.levels)  # type: ignore[union-attr]
    expect(page.locator(".hs-marks .hs-mark-cell")).to_have_count(1)
    page.get_by_label("Close", exact=True).click()
    expect(card).to_be_hidden()


def test_the_keyboard_alone_looks_at_beams(engine: Engine, url: str, kept: Open) -> None:
    """L shows the beam ahead, its buttons take the focus in turn, and keep it from beam to beam."""
    page = seen_from_above(kept, url)
    page.keyboard.press("b")
    number = page.locator("[data-hs-number]")
    expect(number).to_have_attribute("data-hs-number", "90")
    page.keyboard.press("Tab")
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    expect(number).to_have_attribute("data-hs-number", "91")
    page.keyboard.press("Enter")
    expect(number).to_have_attribute("data-hs-number", "92")
    page.keyboard.press("Escape")
    expect(page.locator(CARD)).to_be_hidden()


def test_two_clicks_measure_a_distance(url: str, kept: Open) -> None:
    """In metres of the map, whatever was clicked; no card comes up meanwhile, and Escape takes the line away."""
    page = seen_from_above(kept, url)
    page.keyboard.press("d")
    expect(page.locator(".hs-measure-hint")).to_be_visible()
    click(page, 0.0, 0.0)
    expect(page.locator(".hs-measure-hint")).to_have_text("Click the other place.")
    click(page, 3.0, 1.0)
    length = page.locator(".hs-mark-length")
    expect(length).to_have_count(1)
    assert float((length.text_content() or "").removesuffix(" m")) == pytest.approx(10**0.5, abs=0.1)
    expect(page.locator(CARD)).to_be_hidden()
    page.keyboard.press("Escape")
    expect(page.locator(".hs-marks > *")).to_have_count(0)
    expect(page.locator(".hs-measure-hint")).to_be_hidden()


@pytest.mark.slow
def test_an_entry_of_the_legend_hides_its_layer_in_this_browser(url: str, kept: Open, open_page: Open) -> None:
    """It stays there to be clicked again; other browsers keep theirs."""
    page, other = seen_from_above(kept, url), seen_from_above(open_page, url)
    visible = "window.__viserMutable.nodeRefFromName['/trajectory'].visible"
    entry = page.locator(".hs-legend .hs-entry", has_text="trajectory")
    for shown in (False, True):
        entry.click()
        expect(entry).to_have_attribute("aria-pressed", str(shown).lower())
        page.wait_for_function(f"{visible} === {str(shown).lower()}")
        assert other.evaluate(visible)
