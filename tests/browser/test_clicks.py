"""Who gets a click in the scene, where several tools wait for one."""

import pytest

from hectorscope.session.station_commands import PutMark
from tests.browser.conftest import Open, Show
from tests.browser.test_station import above, live, place, sent

pytestmark = pytest.mark.browser
POINTS = "window.hectorscope.measure.points()?.length"
AIMING = "document.documentElement.classList.contains('hs-aiming')"


def test_a_click_goes_to_the_tool_that_was_taken_last(show: Show, open_page: Open) -> None:
    """A mark that is set while a distance is measured is no end of the distance; the next click is one again."""
    show.engine.show(live())
    page = above(open_page(show.url))
    page.keyboard.press("d")
    page.locator("button[data-hs-station=mark]").click()
    page.mouse.click(*place(page, 1.0, -2.0))
    sent(page, show.engine, PutMark)
    assert page.evaluate(POINTS) == 0
    assert page.evaluate(AIMING)
    page.mouse.click(*place(page, 0.0, 0.0))
    assert page.evaluate(POINTS) == 1
    page.keyboard.press("Escape")
    assert not page.evaluate(AIMING)
