"""A stream as its operator sees it: nothing is lost by one key, and what is the matter stands over the scene."""

from collections.abc import Iterator
from dataclasses import replace

import pytest
from playwright.sync_api import Page, expect

from hectorscope.inputs import Item, SourceReport
from hectorscope.run.warmup import load_everything
from hectorscope.session.commands import Agree, Undo
from hectorscope.session.engine import Engine
from hectorscope.session.snapshot import PlaybackStatus, Question, Snapshot, UndoOffer
from hectorscope.simulation import SceneOptions, Simulation
from hectorscope.web.server import PageServer
from tests.browser.conftest import Open, Show
from tests.engines import START, until
from tests.page import room_snapshot
from tests.sources import MemoryStream

pytestmark = pytest.mark.browser

PATIENCE_S = 120.0
LOADED = "!!window.hectorscope?.tell && !!document.querySelector('.hs-run')"
KEEP, BEGIN = "Keep the map · Enter", "Begin a new map"


class Robot:
    """A drive that has been sent in part, and its page."""

    def __init__(self, drive: list[Item]) -> None:
        self._stream = MemoryStream()
        self._drive = drive
        self.engine = Engine(self._stream, START)
        self.server = PageServer(self.engine, port=0)
        self.server.start()
        self.engine.start()
        self.send(0.0, 0.3)

    def send(self, first: float, last: float) -> None:
        """Shares of the drive."""
        self._stream.send(self._drive[int(first * len(self._drive)) : int(last * len(self._drive))])

    @property
    def now(self) -> Snapshot:
        """The newest snapshot, once everything sent was obeyed."""
        return until(self.engine, lambda now: now.obeyed == self.engine.sent, PATIENCE_S)


@pytest.fixture(scope="module")
def drive() -> list[Item]:
    """Ten seconds, few enough scans for the queue of a stream."""
    load_everything()
    return list(Simulation("rooms", SceneOptions(duration=10.0, scan_rate=5.0, beams=181)).items())


@pytest.fixture
def robot(drive: list[Item]) -> Iterator[Robot]:
    """With a map of some scans."""
    made = Robot(drive)
    try:
        until(made.engine, lambda now: now.scans > 5 and now.maps, PATIENCE_S)
        yield made
    finally:
        made.engine.stop()
        made.server.stop()


def press_r(page: Page) -> None:
    page.locator("canvas[data-engine]").focus()
    page.keyboard.press("r")
    expect(page.get_by_role("button", name=KEEP)).to_be_focused()


def test_r_on_a_stream_asks_and_the_safe_answer_is_the_default(robot: Robot, open_page: Open) -> None:
    """In every browser; Enter and Escape keep the map, from whichever page they come."""
    page, other = open_page(robot.server.url), open_page(robot.server.url)
    before = robot.now
    for key in ("Enter", "Escape"):
        press_r(page)
        labels = page.locator(".mantine-Modal-content button").all_inner_texts()
        assert labels == [KEEP, BEGIN]
        expect(other.get_by_role("button", name=KEEP)).to_be_visible()
        expect(page.locator(".hs-asked")).to_contain_text(f"{before.scans} scans")
        (page if key == "Enter" else other).keyboard.press(key)
        for each in (page, other):
            expect(each.locator(".mantine-Modal-content")).to_have_count(0)
    expect(open_page(robot.server.url).locator(".mantine-Modal-content")).to_have_count(0)
    assert (robot.now.epoch, robot.now.scans) == (before.epoch, before.scans)


def test_a_new_map_of_a_stream_is_undone_for_a_minute(robot: Robot, open_page: Open) -> None:
    """By a button with the seconds left; map, trajectory and figures are there again, and it goes on."""
    page, before = open_page(robot.server.url), robot.now
    press_r(page)
    page.get_by_role("button", name=BEGIN).click()
    until(robot.engine, lambda now: now.epoch > before.epoch, PATIENCE_S)
    expect(page.locator(".hs-readout")).to_have_count(0)
    undo = page.get_by_role("button", name="Undo restart · ")
    expect(undo).to_be_visible()
    seconds = int(undo.inner_text().split("·")[1].split()[0])
    assert 0 < seconds <= 60
    robot.send(0.3, 0.95)  # it moves: the new map begins three seconds later
    until(robot.engine, lambda now: now.scans > 2, PATIENCE_S)
    undo.click()
    expect(undo).to_have_count(0)
    back = until(robot.engine, lambda now: now.scans > before.scans + 2, PATIENCE_S)
    assert back.trajectory[: before.scans].tobytes() == before.trajectory.tobytes()
    expect(page.locator(".hs-readout .hs-figure", has_text="scan").first).to_be_visible()
    page.wait_for_function("!!window.__viserMutable.nodeRefFromName['/floor/map/level0']")


def test_a_stream_shows_what_it_has_use_for(robot: Robot, open_page: Open) -> None:
    """No timeline, no step, no speed; a pause says so in large type, and shows no rate."""
    page = open_page(robot.server.url)
    bar = page.locator("div:has(> div > .hs-bar-transport)")
    expect(page.get_by_role("button", name="Step one scan")).to_have_count(0)
    expect(page.locator(".hs-timeline-track")).to_have_count(0)
    expect(bar.locator(".mantine-Select-root")).to_have_count(0)
    page.get_by_role("button", name="Pause").click()
    until(robot.engine, lambda now: now.playback.state == "paused", PATIENCE_S)
    expect(page.locator(".hs-message-title")).to_have_text("Paused")
    expect(page.locator(".hs-state")).to_have_text("paused")
    expect(page.locator(".hs-run .hs-figure", has_text="scans")).to_have_text("scans–")


def test_a_recording_has_all_of_them(show: Show, open_page: Open) -> None:
    """The same bar with its timeline, step and speed."""
    page = open_page(show.url)
    bar = page.locator("div:has(> div > .hs-bar-transport)")
    expect(page.get_by_role("button", name="Step one scan")).to_be_visible()
    expect(page.locator(".hs-timeline-track")).to_be_visible()
    expect(bar.locator(".mantine-Select-root")).to_be_visible()
    expect(page.locator(".hs-message")).to_be_hidden()


def test_the_key_sentence_stands_over_the_scene(show: Show, open_page: Open) -> None:
    """In large type and whole, also with the panels folded away; the links are told apart beside each other."""
    sentence = "Nothing listens at ws://robot.example:8765: start the bridge there (foxglove_bridge)"
    report = SourceReport(connected=False, waiting=sentence)
    playback = PlaybackStatus("waiting", live=True, detail=sentence)
    show.engine.show(Snapshot(sequence=2, source="ws://robot.example:8765", playback=playback, report=report))
    page = open_page(show.url, LOADED)
    detail = page.locator(".hs-message-detail")
    expect(detail).to_have_text(sentence)
    expect(page.locator(".hs-message-title")).to_have_text("No connection to the robot")
    expect(page.locator(".hs-link-down")).to_have_text("✕ robot: no link")
    expect(page.locator(".hs-hears")).to_have_text("✓ server")
    expect(page.get_by_text("Connected", exact=True)).to_be_hidden()
    assert detail.evaluate("e => e.scrollWidth <= e.clientWidth && parseFloat(getComputedStyle(e).fontSize) >= 16")
    page.keyboard.press("h")
    expect(page.get_by_role("tab", name="Live")).to_be_hidden()
    expect(detail).to_be_in_viewport(ratio=1)
    show.engine.show(replace(room_snapshot(), sequence=3))
    expect(page.locator(".hs-message")).to_be_hidden()


def test_answers_reach_the_engine_with_the_number_of_the_question(show: Show, open_page: Open) -> None:
    """A newer question takes the place of the older, and the undo is the engine's too."""
    asked = Question(1, "The <map> would be lost.", "Begin a new map", "Keep the map")
    offer = UndoOffer("restart", 1e12)
    show.engine.show(replace(room_snapshot(), sequence=2, question=asked, undo=offer))
    page = open_page(show.url)
    expect(page.locator(".hs-asked")).to_have_text("The <map> would be lost.")
    newer = replace(asked, number=2, text="The newer map would be lost.")
    show.engine.show(replace(room_snapshot(), sequence=3, question=newer, undo=offer))
    expect(page.locator(".hs-asked", has_text="newer")).to_be_visible()
    expect(page.get_by_role("button", name=KEEP)).to_have_count(1)
    page.get_by_role("button", name="Begin a new map").click()
    assert until_sent(show, page, 1) == [Agree(2)]
    show.engine.show(replace(room_snapshot(), sequence=4, undo=offer))
    expect(page.locator(".hs-asked")).to_have_count(0)
    page.keyboard.press("u")
    assert until_sent(show, page, 2) == [Agree(2), Undo()]


def until_sent(show: Show, page: Page, count: int) -> list[object]:
    """The commands, once there are so many."""
    for _ in range(600):
        if len(show.engine.sent) >= count:
            break
        page.wait_for_timeout(100)
    return list(show.engine.sent)
