"""The tab of the navigation filter, as a person sees it."""

import pytest
from playwright.sync_api import expect

from tests.browser.conftest import Open, Show
from tests.page import AIDING

pytestmark = pytest.mark.browser

TOO_WIDE = """
() => [...document.querySelectorAll('.hs-fusion, .hs-sources, .hs-biases')].filter(e => {
  const box = e.getBoundingClientRect(), room = e.closest('[role=tabpanel], .mantine-Paper-root') ?? document.body;
  return box.right > room.getBoundingClientRect().right + 1 || e.scrollWidth > e.clientWidth + 1;
}).length
"""


@pytest.mark.parametrize("width", [1000, 400])
def test_the_filter_is_seen_whole_on_a_desk_and_on_a_phone(show: Show, open_page: Open, width: int) -> None:
    """Ellipses, a row a source with its state, and the biases; nothing is wider than its panel."""
    page = open_page(show.url)
    page.set_viewport_size({"width": width, "height": 800})
    page.get_by_role("tab", name="Filter").click()
    expect(page.locator(".hs-sources tbody tr")).to_have_count(len(AIDING))
    expect(page.locator(".hs-sources tr.hs-is-rejected")).to_contain_text("gps")
    expect(page.locator(".hs-ellipses ellipse")).to_have_count(3)
    expect(page.locator(".hs-biases .hs-track")).to_have_count(6)
    assert page.evaluate(TOO_WIDE) == 0
