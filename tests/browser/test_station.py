"""The operator's page: marks and the pose by hand, the sound, viewers, and who is in control."""

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page, ViewportSize, expect

from hectorscope.run.annotations import Annotation
from hectorscope.run.pictures import picture_of
from hectorscope.session.commands import Command
from hectorscope.session.snapshot import LogEntry, Snapshot
from hectorscope.session.station_commands import HandOver, PutMark, PutPicture, Resume, SetPose
from hectorscope.session.station_state import StationState
from hectorscope.web.server import PageServer
from slam_core.results import Verdict
from tests.browser.conftest import PATIENCE, Open, Show
from tests.cases import quick_first
from tests.page import StillEngine, room_snapshot
from tests.pictures import noise_bytes, picture_bytes
from tests.scene import PROJECT, choose_own, look

pytestmark = pytest.mark.browser

OPERATOR, VIEWER = "operator-1234", "viewer-5678"
SIZES: dict[str, ViewportSize] = {
    "desk": {"width": 1280, "height": 800},
    "tablet": {"width": 820, "height": 1180},
    "phone": {"width": 390, "height": 844},
}
MARKS = (
    Annotation(1, "victim", 0, 2.0, 1.0, (0.0, 0.0, 0.0), "<b>waves</b>"),
    Annotation(2, "hazard", 0, -2.0, 1.0, (0.0, 0.0, 0.0)),
)


def live(**station: Any) -> Snapshot:
    """The room, of a stream."""
    still = room_snapshot()
    return replace(
        still,
        playback=replace(still.playback, live=True, end_ns=None, state="playing"),
        station=StationState(**station),
    )


def test_the_run_before_is_offered_by_a_button(show: Show, open_page: Open) -> None:
    """As long as there is one that can be gone on with, whatever became of the question."""
    show.engine.show(live())
    page = above(open_page(show.url))
    button = page.get_by_role("button", name="Go on with the run before")
    expect(button).to_have_count(0)
    show.engine.show(replace(live(past=True), sequence=9))
    button.click()
    assert sent(page, show.engine, Resume) == Resume()


def test_what_failed_comes_up_in_red(show: Show, open_page: Open) -> None:
    """And what somebody asked for and was done, in the colour of the page."""
    show.engine.show(live())
    page = above(open_page(show.url))
    entries = (LogEntry(0, "Kept it", answer=True), LogEntry(0, "It cannot be kept", "warning", answer=True))
    show.engine.show(replace(live(), sequence=9, log=entries))
    colours = [
        page.locator(".mantine-Notification-root", has_text=text).evaluate(
            "notice => getComputedStyle(notice, '::before').backgroundColor"
        )
        for text in ("Kept it", "It cannot be kept")
    ]
    done, failed = ([int(part) for part in re.findall(r"\d+", colour)[:3]] for colour in colours)
    assert failed.index(max(failed)) == 0
    assert done.index(max(done)) != 0


def lost() -> Snapshot:
    """The same once the pose is lost."""
    known = live()
    assert known.result is not None
    return replace(known, sequence=9, result=known.result._replace(verdict=Verdict("lost", None)))


def sent(page: Page, engine: StillEngine, kind: type[Command]) -> Any:
    """The command of a kind that the page has sent, once it has."""
    for _ in range(PATIENCE // 50):
        if found := [command for command in engine.sent if isinstance(command, kind)]:
            return found[-1]
        page.wait_for_timeout(50)
    raise AssertionError(f"no {kind.__name__} was sent")


def place(page: Page, x: float, y: float) -> tuple[float, float]:
    """Where a place of the map is in the window."""
    column, row = page.evaluate(PROJECT, [x, y, 0.0])
    return column, row


def above(page: Page) -> Page:
    """One level, seen from above, and the tab of the station."""
    choose_own(page, layout="one")
    look(page, "top")
    page.get_by_role("tab", name="Station").click()
    return page


@pytest.mark.parametrize("size", quick_first(SIZES))
def test_a_click_sets_a_mark_and_a_drag_the_pose(show: Show, open_page: Open, size: str) -> None:
    """At the place that was clicked, on every screen; the camera stays while the pose is dragged."""
    show.engine.show(live())
    page = above(open_page(show.url, size=SIZES[size]))
    page.locator("[data-hs-station-kind]").select_option("hazard")
    page.locator("[data-hs-station-text]").fill("gas")
    page.locator("button[data-hs-station=mark]").click()
    page.mouse.click(*place(page, 1.0, -2.0))
    mark = sent(page, show.engine, PutMark)
    assert (mark.kind, mark.text) == ("hazard", "gas")
    assert np.allclose((mark.x, mark.y), (1.0, -2.0), atol=0.15)
    page.locator("button[data-hs-station=pose]").click()
    before = place(page, 1.0, -2.0)
    page.mouse.move(*place(page, -2.0, -1.0))
    page.mouse.down()
    page.mouse.move(*place(page, -2.0, -3.0), steps=3)
    page.mouse.up()
    pose = sent(page, show.engine, SetPose)
    assert np.allclose((pose.x, pose.y, pose.yaw), (-2.0, -1.0, -np.pi / 2), atol=0.15)
    assert np.allclose(place(page, 1.0, -2.0), before)


def test_marks_are_drawn_and_listed_as_text(show: Show, open_page: Open) -> None:
    """A letter and the number at their places; what somebody wrote never becomes markup."""
    show.engine.show(live(annotations=MARKS, way_back=np.array([[0.0, 0.0], [3.0, 3.0]])))
    page = above(open_page(show.url))
    expect(page.locator(".hs-station-mark text")).to_have_text(["V1", "!2"])
    assert page.locator(".hs-station-way").count() == 1
    expect(page.locator(".hs-station-marks li b")).to_have_text(["1 victim", "2 hazard"])
    expect(page.get_by_label("Text of mark 1")).to_have_value("<b>waves</b>")
    assert page.locator(".hs-station-marks li b b").count() == 0


@pytest.mark.slow
def test_a_picture_is_chosen_made_small_and_shown(show: Show, open_page: Open, tmp_path: Path) -> None:
    """A large photograph fits into one request; what is no picture is not sent; other pages show it, too."""
    show.engine.show(live(annotations=MARKS))
    page = above(open_page(show.url))
    photograph, text = tmp_path / "photo.png", tmp_path / "text.jpg"
    photograph.write_bytes(noise_bytes((1600, 1200)))
    text.write_text("no picture")
    field = page.get_by_label("Picture for mark 2")
    assert field.get_attribute("accept") == "image/*"
    field.set_input_files(text)
    expect(page.locator("[data-hs-station-picture-told]")).to_contain_text("cannot be read as a picture")
    assert not any(isinstance(command, PutPicture) for command in show.engine.sent)
    field.set_input_files(photograph)
    put = sent(page, show.engine, PutPicture)
    assert put.number == 2
    picture = picture_of(put.content)
    show.engine.show(replace(live(annotations=(MARKS[0], replace(MARKS[1], picture=picture))), sequence=9))
    for each in (page, above(open_page(show.url))):
        shown = each.get_by_alt_text("Picture of mark 2")
        expect(shown).to_be_visible()
        each.wait_for_function("document.querySelector('.hs-station-picture img')?.naturalWidth > 100")


@pytest.mark.slow
def test_it_sounds_while_tracking_is_lost_where_that_is_allowed(show: Show, open_page: Open) -> None:
    """In a browser that switched the sound on, and not in another one."""
    show.engine.show(live())
    loud, quiet = above(open_page(show.url)), open_page(show.url)
    loud.locator("input[data-hs-own=sound]").check()
    before = loud.evaluate("window.hectorscope.beeps()")
    assert before == 1  # so that one hears what it is
    show.engine.show(lost())
    loud.wait_for_function(f"window.hectorscope.beeps() >= {before} + 2")
    expect(quiet.locator(".hs-message-title")).to_have_text("Tracking lost")
    assert quiet.evaluate("window.hectorscope.beeps()") == 0


@pytest.fixture
def station() -> Iterator[tuple[StillEngine, PageServer]]:
    """A page with roles."""
    engine = StillEngine(live())
    server = PageServer(engine, port=0, token=OPERATOR, viewer_token=VIEWER)
    server.start()
    yield engine, server
    server.stop()


def acted(engine: StillEngine) -> list[Command]:
    """What pages asked for, without the words of the server itself."""
    return [command for command in engine.sent if not isinstance(command, HandOver)]


# Curves are asked for again, as a viewer may do; the page forgets that it has them.
ASK_FOR_CURVES = """() => {
  window.hectorscope.plotted().tables.series.known = 0;
  const uuid = document.querySelector("[data-hs-charts]").dataset.hsAsk;
  window.__viserMutable.sendMessage({ type: "GuiUpdateMessage", uuid, updates: { value: true } });
}"""
CURVES = "window.hectorscope.plotted().tables.series?.known > 0"


def test_a_viewer_sees_and_does_nothing(station: tuple[StillEngine, PageServer], open_page: Open) -> None:
    """The page says so, shows curves like any other, and its requests never arrive."""
    engine, server = station
    page = open_page(server.viewers_url, own={})
    expect(page.locator(".hs-control")).to_have_text("You are a viewer: this page only looks.Take control")
    expect(page.locator(".hs-control button")).to_be_hidden()
    page.wait_for_function(CURVES)
    page.evaluate("window.hectorscope.request('station', {mark: ['note', 1, 1, 'mine']})")
    page.keyboard.press("r")
    page.keyboard.press("Space")
    page.evaluate(ASK_FOR_CURVES)
    page.wait_for_function(CURVES)  # messages of a page are read in order: the server has those before, too
    own = open_page(server.url)
    own.evaluate("window.hectorscope.request('station', {mark: ['note', 2, 2, 'operator']})")
    assert sent(own, engine, PutMark).text == "operator"
    assert len(acted(engine)) == 1


def test_a_viewer_sees_the_pictures_of_marks(station: tuple[StillEngine, PageServer], open_page: Open) -> None:
    """It asks for them, which changes nothing, and can put none."""
    engine, server = station
    picture = picture_of(picture_bytes())
    engine.show(replace(live(annotations=(replace(MARKS[0], picture=picture),)), sequence=9))
    page = open_page(server.viewers_url)
    page.get_by_role("tab", name="Station").click()
    page.wait_for_function("document.querySelector('.hs-station-picture img')?.naturalWidth === 64")
    page.evaluate("window.hectorscope.request('station', {picture: [1, 'AAEC']})")
    page.evaluate(ASK_FOR_CURVES)
    page.wait_for_function(CURVES)  # messages of a page are read in order: the server has that before, too
    assert acted(engine) == []


def ask(page: Page, text: str) -> None:
    """Set a mark as a script of the page does."""
    page.evaluate("(text) => window.hectorscope.request('station', {mark: ['note', 1, 1, text]})", text)


def test_control_is_handed_over_between_two_operators(
    station: tuple[StillEngine, PageServer], open_page: Open
) -> None:
    """The other page is told, and takes control with a button; then the first one waits."""
    engine, server = station
    first, second = open_page(server.url), open_page(server.url)
    ask(first, "first")
    assert sent(first, engine, PutMark).text == "first"
    button = second.get_by_role("button", name="Take control")
    button.click()
    expect(first.locator(".hs-control")).to_contain_text("Another operator is in control")
    expect(button).to_be_hidden()
    ask(first, "first again")
    engine.sent.clear()
    ask(second, "second")
    assert sent(second, engine, PutMark).text == "second"
    assert [command.text for command in acted(engine) if isinstance(command, PutMark)] == ["second"]
