"""The X-ray of a real scan in a real browser: iterations, landscape, dragged start, lens; each browser its own."""

import contextlib
import re

import numpy as np
import pytest
from playwright.sync_api import Page, TimeoutError, expect

from hectorscope.panels._xray_places import along_axes, compare
from hectorscope.run.xray.attitude import passage
from hectorscope.run.xray.match_problem import MatchProblem, problem_of
from hectorscope.session.commands import Seek, StepScan
from hectorscope.session.engine import Engine
from hectorscope.session.snapshot import Snapshot
from hectorscope.web.server import PageServer
from tests.browser.conftest import Open
from tests.engines import after, until
from tests.scene import PROJECT, choose_own, look
from tests.xray import grip

pytestmark = pytest.mark.browser
BEAMS = 361
CARD = ".hs-xray"
WORDS = ".hs-xray-words"
SCAN = ".hs-xray-scan span"
# Millimetres from the matched pose: of the start, and of the end that the matcher reaches from there.
OFFSETS = """() => ["start", "end"].map((name) => {
  const row = [...document.querySelectorAll(".hs-xray-words tr")].find((at) => at.textContent.startsWith(name));
  return row.querySelector("td").textContent.replaceAll("−", "-").split(", ").slice(0, 2).map(parseFloat);
})"""
THERE = "(name) => !!window.__viserMutable.nodeRefFromName[name]?.visible"


def resting(engine: Engine) -> tuple[Snapshot, MatchProblem]:
    """Six seconds after the start, and the scan shown there."""
    latest = engine.mailbox.latest
    assert latest is not None
    now = after(engine, Seek(latest.playback.start_ns + 6_000_000_000))
    return now, problem(now)


def problem(now: Snapshot) -> MatchProblem:
    assert now.rework is not None and now.result is not None
    found = problem_of(now.rework.before(now.ahead.settings), now.result, now.config)
    assert found is not None
    return found


def looking_inside(open_page: Open, url: str) -> Page:
    page = open_page(url)
    choose_own(page, layout="one")
    look(page, "follow")
    look(page, "top")
    page.keyboard.press("i")
    expect(page.locator(CARD)).to_be_visible()
    return page


def choose(page: Page, lab: str) -> None:
    page.locator(CARD).get_by_role("button", name=lab, exact=True).click()


def drag(page: Page, start: np.ndarray, metres: float) -> None:
    """Pull the arrow of the handle along the robot's heading; once more if the page was too busy to notice."""
    begin, finish = grip(page, start, metres)
    for _ in range(10):
        page.mouse.move(*begin.tolist())
        page.evaluate("() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)))")
        page.mouse.down()
        for share in np.linspace(0.1, 1.0, 10):
            page.mouse.move(*(begin + share * (finish - begin)).tolist())
        page.mouse.up()
        with contextlib.suppress(TimeoutError):
            page.wait_for_function(
                f"(far) => Math.hypot(...({OFFSETS})()[0]) > far", arg=600 * metres, timeout=5_000
            )
            return


def test_the_iterations_are_stepped_through(engine: Engine, url: str, open_page: Open) -> None:
    """Each with its cost and its beams on its level; another scan has other numbers; closing takes all away."""
    _, found = resting(engine)
    steps = found.iterations(found.start)
    page = looking_inside(open_page, url)
    words = page.locator(WORDS)
    expect(words).to_contain_text(f"{steps[0].cost:.3f}")
    expect(page.locator(CARD)).to_contain_text(f"1 of {len(steps)}")
    page.wait_for_function(THERE, arg=f"/floor/map/level{steps[0].level}/xray/points")
    page.get_by_label("Next iteration").click()
    expect(words).to_contain_text(f"{steps[1].cost:.3f}")
    page.get_by_role("button", name="Play", exact=True).click()
    expect(words).to_contain_text("evaluation at ξ*")
    expect(words).to_contain_text(f"{steps[-1].cost:.3f}")
    expect(page.locator(".hs-marks .hs-xray-axis")).to_have_count(2)
    after(engine, StepScan())
    other = problem(until(engine, lambda now: now.rework is not None))
    expect(words).to_contain_text(f"{other.iterations(other.start)[-1].cost:.3f}")
    page.keyboard.press("i")
    expect(page.locator(CARD)).to_be_hidden()
    expect(page.locator(".hs-marks > *")).to_have_count(0)
    page.wait_for_function("() => !window.__viserMutable.nodeRefFromName['/floor/xray_start']?.visible")


@pytest.mark.slow
def test_each_browser_looks_at_what_it_wants(engine: Engine, url: str, open_page: Open) -> None:
    """One at the landscape of a level, another at the covariances, a third at nothing."""
    resting(engine)
    one, two, three = (looking_inside(open_page, url), looking_inside(open_page, url), open_page(url))
    choose(one, "Landscape")
    choose(two, "Covariance")
    expect(one.locator(WORDS)).to_contain_text("lowest (7)")
    expect(two.locator(WORDS)).to_contain_text("scan R (15)")
    expect(two.locator(WORDS)).to_contain_text("cloud of 400")
    one.wait_for_function(THERE, arg="/floor/map/level0/xray/heat")
    assert "/floor/map/level0/xray/heat" not in two.evaluate("Object.keys(window.__viserMutable.nodeRefFromName)")
    assert three.evaluate(
        "Object.keys(window.__viserMutable.nodeRefFromName).every((name) => !name.includes('xray'))"
    )
    expect(three.locator(CARD)).to_be_hidden()


@pytest.mark.slow
def test_who_only_looks_keeps_a_scan_and_drags_its_start(engine: Engine, url: str, open_page: Open) -> None:
    """The operator steps on: the own page follows the run; the viewer's scan, step and start stay its own."""
    _, found = resting(engine)
    server = PageServer(engine, port=0, token="operator-1234", viewer_token="viewer-5678")
    server.start()
    try:
        operator, viewer = (looking_inside(open_page, address) for address in (server.url, server.viewers_url))
        first = operator.locator(SCAN).inner_text()
        for page in (operator, viewer):
            choose(page, "Landscape")
            expect(page.locator(WORDS)).to_contain_text("ends at ξ*")
        viewer.get_by_role("button", name="Keep this scan").click()
        viewer.wait_for_function("() => !!window.__viserMutable.nodeRefFromName['/floor/xray_start']")
        drag(viewer, found.start, 1.5)
        viewer.wait_for_function(f"() => Math.hypot(...({OFFSETS})()[0]) > 1400")  # the end of the drag
        start = viewer.evaluate(OFFSETS)[0]
        assert np.hypot(*operator.evaluate(OFFSETS)[0]) < 900.0
        operator.keyboard.press(".")
        expect(operator.locator(SCAN)).not_to_have_text(first)
        choose(viewer, "1")
        expect(viewer.locator(WORDS)).to_contain_text("Level 1")
        expect(operator.locator(WORDS)).to_contain_text("Level 0")
        expect(viewer.locator(SCAN)).to_have_text(first)
        np.testing.assert_allclose(viewer.evaluate(OFFSETS)[0], start, atol=0.01)
        viewer.get_by_role("button", name="Keep this scan").click()
        expect(viewer.locator(SCAN)).to_have_text(operator.locator(SCAN).inner_text())
    finally:
        server.stop()


def test_the_landscape_shows_the_cost_of_each_level(engine: Engine, url: str, open_page: Open) -> None:
    """The lowest cost is the reference's at the matched pose; a basin is tried until every start was."""
    _, found = resting(engine)
    lowest = found.iterations(found.matched)[-1].cost
    page = looking_inside(open_page, url)
    choose(page, "Landscape")
    words = page.locator(WORDS)
    row = words.locator("tr", has_text="lowest (7)").locator("td")
    expect(row).to_have_text(re.compile(r"^\d+\.\d+$"))
    assert float(row.text_content() or "") == pytest.approx(lowest, rel=0.01)
    choose(page, "2")
    expect(words).to_contain_text("Level 2")
    page.wait_for_function(THERE, arg="/floor/map/level2/xray/heat")
    choose(page, "basin")
    expect(words).to_contain_text("3721 of 3721")


@pytest.mark.slow
def test_the_start_is_dragged_by_its_handle(engine: Engine, url: str, open_page: Open) -> None:
    """The matcher follows while the hand moves, and ends where the core does; the run is not touched."""
    now, found = resting(engine)
    page = looking_inside(open_page, url)
    choose(page, "Landscape")
    words = page.locator(WORDS)
    expect(words).to_contain_text("ends at ξ*")
    page.wait_for_function("() => !!window.__viserMutable.nodeRefFromName['/floor/xray_start']")
    drag(page, found.start, 1.5)
    start, end = np.array(page.evaluate(OFFSETS))
    assert 900.0 < np.hypot(*start) < 1600.0
    dragged = found.matched + np.array([*(1e-3 * start), found.start[2] - found.matched[2]])
    np.testing.assert_allclose(end, 1e3 * (found.end(dragged).pose - found.matched)[:2], atol=2.0)
    page.get_by_role("button", name="Start as the run did").click()
    expect(words).to_contain_text("ends at ξ*")
    latest = engine.mailbox.latest
    assert latest is not None
    np.testing.assert_array_equal(latest.trajectory, now.trajectory)


@pytest.mark.slow
def test_covariances_of_three_places_are_compared(engine: Engine, url: str, open_page: Open) -> None:
    """A click simulates a room, a corridor and open water; the figures on the card are those of the core."""
    resting(engine)
    page = looking_inside(open_page, url)
    choose(page, "Covariance")
    choose(page, "room, corridor, water")
    words = page.locator(WORDS)
    expect(words.locator(".hs-xray-place")).to_have_count(3)
    expect(words.locator("h3", has_text="cloud of 400")).to_have_count(3)
    expected = compare("corridor", 0.02)
    while not expected.cloud.whole:
        expected.cloud.try_next()
    rows = words.locator(".hs-xray-table").nth(1).locator("tr:has(td)")
    shown = [[float(cell) for cell in row.locator("td").all_inner_texts()] for row in rows.all()]
    figures = [[1e3 * u, 1e3 * v, np.degrees(psi)] for u, v, psi in along_axes(expected.covariances).values()]
    np.testing.assert_allclose(shown, figures, atol=0.006)
    choose(page, "this scan")
    expect(words).to_contain_text("scan R (15)")


@pytest.mark.slow
def test_eq_1_is_looked_at_up_to_90_degrees(engine: Engine, url: str, open_page: Open) -> None:
    """The slider puts its pitch into the equation."""
    resting(engine)
    page = looking_inside(open_page, url)
    choose(page, "Attitude")
    slider = page.get_by_label("Pitch θ, °")
    for degrees in (60, 75):
        slider.fill(str(degrees))
        found = passage(np.radians(degrees))
        expect(page.locator(WORDS)).to_contain_text(f"{np.degrees(found.by_angles):.3f}")
    slider.fill("90")
    expect(page.locator(WORDS)).to_contain_text("10¹⁶")


def test_a_click_looks_at_a_cell_through_the_lens(engine: Engine, url: str, open_page: Open) -> None:
    """Four corners with M and gradient; the card of a closer look stays away."""
    _, found = resting(engine)
    page = looking_inside(open_page, url)
    choose(page, "Lens")
    expect(page.locator(WORDS)).to_contain_text("Click a place")
    column, row = page.evaluate(PROJECT, [*(found.matched[:2] + 0.4).tolist(), 0.0])
    page.mouse.click(column, row)
    expect(page.locator(WORDS)).to_contain_text("∂M/∂x (5)")
    expect(page.locator(".hs-marks .hs-xray-cell")).to_have_count(4)
    expect(page.locator(".hs-closer")).to_be_hidden()


@pytest.mark.slow
def test_each_browser_goes_to_a_scan_of_its_own(engine: Engine, url: str, open_page: Open) -> None:
    """A viewer looks at any scan, also while the run goes on: what is shown is what a seek to it would show."""
    now, _ = resting(engine)
    assert now.other_scans is not None
    times = now.other_scans.times
    third = float(times[3])
    server = PageServer(engine, port=0, token="operator-1234", viewer_token="viewer-5678")
    server.start()
    try:
        page = looking_inside(open_page, server.viewers_url)
        words, scan = page.locator(WORDS), page.locator(SCAN)
        expect(words).to_contain_text("(13)")
        own = scan.inner_text()
        page.get_by_label("Next scan, for this browser alone").click()
        expect(scan).not_to_have_text(own)
        page.get_by_label("Scan before, for this browser alone").click()
        expect(scan).to_have_text(own)
        page.get_by_label("Scan of this browser alone").fill(f"{third:.1f}")
        expect(scan).to_have_text(f"Scan at {third:.2f} s")
        choose(page, "Landscape")
        expect(words).to_contain_text("ends at ξ*")
        assert after(engine).playback.time_ns == now.playback.time_ns
        after(engine, Seek(now.playback.start_ns + round(1e9 * third)))
        expect(scan).to_have_text(f"Scan at {third:.2f} s")
        before = page.evaluate(OFFSETS)
        page.get_by_role("button", name="Keep this scan").click()
        expect(page.get_by_role("button", name="Keep this scan")).to_have_attribute("aria-pressed", "false")
        expect(scan).to_have_text(f"Scan at {third:.2f} s")
        assert page.evaluate(OFFSETS) == before
    finally:
        server.stop()
