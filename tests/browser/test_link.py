"""A link that breaks, as it looks to somebody who steers by the page."""

from urllib.parse import urlsplit

import pytest
from playwright.sync_api import expect

from hectorscope.web.server import PageServer
from tests.browser.conftest import READY, Open, Show

pytestmark = pytest.mark.browser

NEXT_HEARTBEAT = """new Promise((heard) => {
  const beat = window.hectorscope.beat;
  window.hectorscope.beat = () => (beat(), heard());
})"""
# viser talks to the server from a worker.
DEAF = "Worker.prototype.postMessage = () => {};"
# The clock of the page, set forward by `window.later` milliseconds.
CLOCK = "{ const now = performance.now.bind(performance); performance.now = () => now() + (window.later ?? 0); }"


def test_a_broken_link_is_seen_and_mended(show: Show, open_page: Open) -> None:
    """Nothing looks live while the server is silent, and once it is back the page is, with nobody's help."""
    first = PageServer(show.engine, port=0)  # of its own: that of `show` is for the next test, too
    first.start()
    page = open_page(first.url)
    page.wait_for_function("document.hidden === false")
    page.evaluate(NEXT_HEARTBEAT)
    first.stop()
    silence = page.locator(".hs-message", has_text="No message from the server")
    expect(silence).to_be_visible()
    expect(silence).to_contain_text("The picture is")
    expect(page.locator(".hs-deaf")).to_be_visible()
    with page.expect_event("requestfailed", lambda request: request.url.endswith("healthz")):
        pass  # the page has asked whether it may open itself again
    port = urlsplit(first.url).port
    assert port is not None
    again = PageServer(show.engine, port=port)
    again.start()
    try:
        expect(silence).to_be_hidden()
        page.wait_for_function(READY)
    finally:
        again.stop()


@pytest.mark.slow
def test_a_server_that_never_says_anything_is_named(show: Show, open_page: Open) -> None:
    """A page that was served but never heard its server does not look live either."""
    page = open_page(show.url, ready="document.readyState === 'complete'", before=CLOCK + DEAF)
    page.evaluate("window.later = 19_000")
    expect(page.locator(".hs-message")).to_contain_text("since the page was opened")
