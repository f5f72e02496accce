"""A link to a view: copied in one browser, followed in another one, in front of another server."""

from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from hectorscope.session.commands import Configure, Pause, Seek, SetSpeed
from hectorscope.session.commands import Open as OpenRecording
from tests.browser.conftest import LISTED, READY, Open, Opened
from tests.engines import after, until
from tests.page import LATE_CAMERA
from tests.scene import RESTS

pytestmark = pytest.mark.browser

PATIENCE_S = 120.0
# Where the link ends up instead of in the clipboard of the machine.
CLIPBOARD = """Object.defineProperty(navigator, 'clipboard', {
  value: { writeText: async (text) => (window.copied = text) } })"""
# A message goes away after some seconds, in which a page that has just been opened may be busy.
SEEN = """window.seen = '';
new MutationObserver((records) => records.forEach(({ addedNodes }) =>
  addedNodes.forEach((node) => (window.seen += node.textContent))))
  .observe(document, { childList: true, subtree: true, characterData: true })"""
CAMERA = "window.hectorscope.cameraNow()"
VIEW = "window.__viserMutable.cameraControl.setLookAt(3, 9, 4, 1, 0, 2, false)"
TOUCH = "document.querySelector('canvas[data-engine]').dispatchEvent(new WheelEvent('wheel'))"


def copied(page: Page) -> str:
    """The link to what is shown."""
    page.wait_for_function("JSON.parse(document.querySelector('[data-hs-link]').dataset.hsLink).link")
    page.locator("body").press("c")
    page.wait_for_function("window.copied")
    link: str = page.evaluate("window.copied")
    return link


def test_a_link_restores_the_view_in_a_fresh_browser(opened: Opened, open_page: Open, bags: Path) -> None:
    """Recording, time, settings and camera; it leaves the address, and the page says that it was copied."""
    key = next(each.key for each in opened.engine.mailbox.latest.library if each.name == "kitchen.bag")  # type: ignore[union-attr]
    shown = after(opened.engine, OpenRecording(key), SetSpeed(float("inf")))
    after(opened.engine, Pause(), Seek(shown.playback.start_ns + 2_000_000_000))
    shown = after(opened.engine, Configure("fusion.omega", 0.2))
    page = open_page(opened.server.url, before=CLIPBOARD)
    page.wait_for_function(RESTS)
    page.evaluate(TOUCH)
    page.evaluate(VIEW)
    page.wait_for_function("window.hectorscope.cameraState().auto === false")
    link, camera = copied(page), page.evaluate(CAMERA)
    expect(page.locator(".hs-said")).to_have_text("The link is copied.")

    other = Opened(bags)
    try:
        until(other.engine, lambda now: now.playback.state == "empty", PATIENCE_S)
        fresh = open_page(other.server.url + "#" + link.partition("#")[2], READY)
        restored = until(other.engine, lambda now: now.playback.state == "paused" and now.scans, PATIENCE_S)
        assert restored.trajectory.tobytes() == shown.trajectory.tobytes()
        assert restored.config == shown.config
        assert "#" not in fresh.url
        fresh.wait_for_function(
            f"{CAMERA}.pose.every((value, at) => Math.abs(value - {camera['pose']}[at]) < 0.01)"
        )
        assert {**fresh.evaluate(CAMERA), "pose": None} == {**camera, "pose": None}
    finally:
        other.stop()


def test_a_link_is_followed_however_late_the_server_knows_the_page(opened: Opened, open_page: Open) -> None:
    """What was said before is not heard, and neither is the same again."""
    page = open_page(f"{opened.server.url}#r=<b>", LISTED, before=f"{SEEN};{LATE_CAMERA}")
    page.wait_for_timeout(2000)
    page.evaluate("window.cameraHeard = true")
    page.evaluate(VIEW)
    page.wait_for_function("window.seen.includes('This link cannot be followed')")


@pytest.mark.parametrize(
    ("link", "words"),
    [
        ("r=" + "0" * 64 + ".7&t=1", "The recording of this link (0.0 MiB) is none of those"),
        ("r=" + "0" * 64 + ".7&t=1&s=fusion.omega:9", "This link cannot be followed: fusion.omega is 9"),
        ("r=<b>", "This link cannot be followed: a part of it is missing or damaged"),
        ("r=" + "0" * 2000, "This link cannot be followed: it is too long."),
    ],
)
def test_a_link_that_cannot_be_followed_is_one_message(
    opened: Opened, open_page: Open, link: str, words: str
) -> None:
    """The page stays as it is."""
    page = open_page(f"{opened.server.url}#{link}", LISTED, before=SEEN)
    page.wait_for_function("(words) => window.seen.includes(words)", arg=words)
    assert opened.engine.mailbox.latest is not None
    assert opened.engine.mailbox.latest.playback.state == "empty"
