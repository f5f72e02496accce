"""The lessons, as a learner walks them: open, see the scene, try, answer, go on."""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page, ViewportSize, expect

from hectorscope.cli.opening import demos
from hectorscope.inputs import Source, SourceOptions
from hectorscope.page.lessons import Lesson, lessons_in
from hectorscope.run.warmup import load_everything
from hectorscope.session.commands import Seek
from hectorscope.session.engine import Engine
from hectorscope.session.library import Library
from hectorscope.sources import open_source
from hectorscope.web.server import PageServer
from tests.browser.conftest import Open
from tests.conftest import ROOT
from tests.engines import until
from tests.scene import PROJECT, look

pytestmark = pytest.mark.browser
LESSONS = lessons_in(ROOT / "static" / "lessons")
LOADED = (  # before the curves have come, the server hears nothing of the page
    "!!window.hectorscope?.lessons && !!document.querySelector('[data-hs-request=lesson]')"
    " && !!hectorscope.plotted().tables.series"
)
DRAWN = "!!hectorscope.levels().places.length && !!__viserMutable.nodeRefFromName['/robot']"
NOTICE = ".mantine-Notification-closeButton"  # of software graphics; it may lie over the card
SIGMA = "Scale of the match covariance, σ"
PATIENCE_S = 180.0
SIZE: ViewportSize = {"width": 1280, "height": 800}  # room for the card beside the robot


class School:
    """A server with the recordings that come with the program, and none open."""

    def __init__(self) -> None:
        self.engine = Engine(None, ahead_after=None)
        self.engine.offer(Library(self._open, demos=demos()))
        self.server = PageServer(self.engine, port=0)
        self.server.start()
        self.engine.start()

    def _open(self, path: Path, sensors: Mapping[str, Any]) -> Source:
        return open_source(str(path), SourceOptions(**sensors))

    def wait(self, lesson: Lesson) -> None:
        """Until the scene of a lesson stands."""
        wanted_ns = lesson.offset_ns
        until(
            self.engine,
            lambda now: (
                now.playback.state == "paused"
                and lesson.demo in now.source
                and now.config == lesson.settings.start
                and abs(now.playback.time_ns - now.playback.start_ns - wanted_ns) < 10**9
            ),
            PATIENCE_S,
        )

    def play_to(self, seconds: float) -> None:
        """Go on to a time of the recording."""
        latest = self.engine.mailbox.latest
        assert latest is not None
        self.engine.send(Seek(latest.playback.start_ns + round(seconds * 1e9)))


@pytest.fixture(scope="module")
def school() -> Iterator[School]:
    load_everything()
    made = School()
    yield made
    made.engine.stop()
    made.server.stop()


def setting(page: Page, label: str) -> Any:
    """The row of a setting in its tab."""
    page.get_by_role("tab", name="Settings").click()
    return page.locator(".mantine-Flex-root", has=page.locator(f"label:text-is('{label}')"))


def behind_the_robot(page: Page, school: School) -> None:
    """A click where no beam ends, with the robot in the middle of the scene."""
    look(page, "follow")
    latest = school.engine.mailbox.latest
    assert latest is not None and latest.result is not None
    x, y, yaw = latest.result.planar
    page.mouse.click(*page.evaluate(PROJECT, [x - 0.5 * np.cos(yaw), y - 0.5 * np.sin(yaw), 0.0]))


def stabilise_off(page: Page, school: School) -> None:
    setting(page, "Stabilise").get_by_role("checkbox").click()
    until(school.engine, lambda now: not now.config.scan.stabilise, PATIENCE_S)
    school.play_to(26.0)


def kalman(page: Page, school: School) -> None:
    setting(page, "Fusion method").locator("input").first.click()
    page.locator("[role=option]:visible", has_text="kalman").click()
    until(school.engine, lambda now: now.config.fusion.method == "kalman", PATIENCE_S)
    school.play_to(31.0)


def compare(page: Page, school: School) -> None:
    page.get_by_role("tab", name="Runs").click()
    page.get_by_role("button", name="Compare with the paper").click()


TASKS: dict[str, Callable[[Page, School], None]] = {
    "1-one-beam": lambda page, _: page.keyboard.press("b"),
    "2-between-cells": behind_the_robot,
    "3-gauss-newton": lambda page, _: setting(page, "Iterations fine").get_by_role("textbox").fill("6"),
    "4-pyramid": lambda page, _: setting(page, "Levels").get_by_role("textbox").fill("1"),
    "5-which-way-is-down": stabilise_off,
    "6-how-sure": lambda page, _: setting(page, SIGMA).get_by_role("textbox").fill("1"),
    "7-paper-and-today": compare,
    "8-covariance-intersection": kalman,
}


def walks() -> list[Any]:
    """A case for each lesson. All but the first and the last are slow."""
    inner = LESSONS[1:-1]
    return [
        pytest.param(lesson, id=lesson.key, marks=[pytest.mark.slow] if lesson in inner else [])
        for lesson in LESSONS
    ]


def test_there_are_eight_lessons_and_each_is_walked_here():
    """A lesson that is added without a walk is noticed."""
    assert [lesson.key for lesson in LESSONS] == sorted(TASKS)
    assert len(LESSONS) == 8


@pytest.mark.parametrize("lesson", walks())
def test_a_lesson_from_start_to_end(school: School, open_page: Open, lesson: Lesson):
    """Opened by its key, it sets up its scene, is not done before its task is, and judges the answers."""
    page = open_page(school.server.url, LOADED, SIZE)
    page.add_locator_handler(page.locator(NOTICE).first, lambda notice: notice.click())
    page.keyboard.press("e")
    page.get_by_role("button", name=lesson.title).click()
    school.wait(lesson)
    task = page.locator(".hs-task")
    expect(page.locator(".hs-lesson-body .katex").first).to_be_visible()
    page.wait_for_function(DRAWN)
    expect(task).not_to_have_attribute("data-done", "")
    TASKS[lesson.key](page, school)
    expect(task).to_have_attribute("data-done", "", timeout=PATIENCE_S * 1000)
    wrong = (lesson.question.right + 1) % len(lesson.question.answers)
    page.locator(f"[data-answer='{wrong}']").click()
    expect(page.locator(".hs-why")).to_contain_text("Not quite.")
    page.locator(f"[data-answer='{lesson.question.right}']").click()
    expect(page.locator(".hs-why")).to_contain_text("Right.")
    assert page.locator(".katex-error").count() == 0


@pytest.mark.slow
def test_answers_stay_in_this_browser(school: School, open_page: Open):
    """A page that is opened again remembers; that of another person does not."""
    page = open_page(school.server.url, LOADED)
    page.evaluate("hectorscope.lessons.toggle().then(() => hectorscope.lessons.open('1-one-beam', false))")
    page.locator("[data-answer='0']").click()
    page.reload()
    page.wait_for_function(LOADED)
    page.evaluate("hectorscope.lessons.toggle().then(() => hectorscope.lessons.open('1-one-beam', false))")
    expect(page.locator("[data-answer='0']")).to_have_attribute("aria-pressed", "true")
    other = open_page(school.server.url, LOADED)
    other.evaluate("hectorscope.lessons.toggle().then(() => hectorscope.lessons.open('1-one-beam', false))")
    expect(other.locator("[data-answer='0']")).to_have_attribute("aria-pressed", "false")
