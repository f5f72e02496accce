"""A class: what the teacher looks at, others see, until they explore on their own."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Page, expect

from hectorscope.web.server import PageServer
from tests.browser.conftest import Open, Show
from tests.page import StillEngine, room_snapshot
from tests.scene import choose_own

pytestmark = pytest.mark.browser
BAR = ".hs-class"
NOTICE = ".mantine-Notification-closeButton"  # of software graphics; it may lie over the bar
FROM_ABOVE = "hectorscope.cameraState().top"


@pytest.fixture
def server() -> Iterator[PageServer]:
    made = PageServer(StillEngine(room_snapshot()), port=0, teacher="the-key-of-the-teacher")
    made.start()
    yield made
    made.stop()


def has(page: Page, **choices: str) -> None:
    """Wait until a browser has chosen these."""
    for name, value in choices.items():
        page.wait_for_function("([name, value]) => hectorscope.own.get(name) === value", arg=[name, value])


@pytest.mark.slow
def test_students_follow_camera_layout_and_layers(server: PageServer, open_page: Open):
    """Those who came before and who come later; the key is no longer in the address."""
    early = open_page(server.url)
    teacher = open_page(server.teacher_url)
    assert "teach" not in teacher.url
    choose_own(teacher, layout="side", layers={"trajectory": False})
    teacher.evaluate("hectorscope.camera('top')")
    late = open_page(server.url)
    for page in (early, late):
        has(page, layout="side")
        page.wait_for_function("hectorscope.own.get('layers').trajectory === false")
        page.wait_for_function(FROM_ABOVE)
        expect(page.locator(BAR)).to_contain_text("Following the teacher")


def test_a_view_from_a_place_is_that_place(server: PageServer, open_page: Open):
    """Where the teacher's camera is, there the student's comes to rest."""
    teacher, student = open_page(server.teacher_url), open_page(server.url)
    teacher.evaluate("hectorscope.camera('free'); __viserMutable.cameraControl.setLookAt(7, 8, 9, 1, 0, 2, false)")
    student.wait_for_function(
        "(({x, y, z}) => Math.hypot(x - 7, y - 8, z - 9) < 0.1)(__viserMutable.cameraControl.getPosition())"
    )


@pytest.mark.slow
def test_who_explores_keeps_the_own_view(server: PageServer, open_page: Open):
    """A drag in the scene ends following and brings the own choices back; a button follows again."""
    student = open_page(server.url, own={"layout": "one", "plots": "off"})
    teacher = open_page(server.teacher_url)
    choose_own(teacher, layout="side")
    has(student, layout="side")
    student.mouse.move(300, 300)
    student.mouse.down()
    student.mouse.up()
    expect(student.locator(BAR)).to_contain_text("On your own")
    has(student, layout="one")
    choose_own(teacher, layout="stacked")
    student.add_locator_handler(student.locator(NOTICE).first, lambda notice: notice.click())
    student.locator(f"{BAR} button").click()
    has(student, layout="stacked")


@pytest.mark.slow
def test_a_wrong_key_teaches_nobody(server: PageServer, open_page: Open):
    """The class keeps the view that it has."""
    teacher, student = open_page(server.teacher_url), open_page(server.url)
    choose_own(teacher, layout="side")
    has(student, layout="side")
    fake = open_page(f"{server.url}#teach=the-key-of-nobody")
    choose_own(fake, layout="one")
    choose_own(teacher, gap=1.5)
    student.wait_for_function("hectorscope.own.get('gap') === 1.5")
    has(student, layout="side")


def test_without_a_class_there_is_nothing_to_follow(show: Show, open_page: Open):
    """No bar, and no request that the server hears."""
    page = open_page(show.url)
    expect(page.locator(BAR)).to_be_hidden()
    assert page.locator("[data-hs-request=class]").count() == 0
