"""The sensors of a recording contradict each other: the page shows what was found, and repairs it."""

import time
from dataclasses import replace

from playwright.sync_api import expect

from hectorscope.inputs import Finding, SourceReport
from hectorscope.session.commands import Examine, Repair, Seek
from hectorscope.session.snapshot import PlaybackStatus
from tests.browser.conftest import Open, Show
from tests.page import room_snapshot

FOUND = (
    Finding("the accelerometer shows <gravity> as 986.7", {"imu_accel_unit": "mg"}),
    Finding("scans and gyroscope turn opposite ways", {"scan_mirrored": True}),
)
LATE = (Finding("the scans are stamped 0.11 s late", {"scan_delay": 0.11}, grave=False),)
WRONG = (
    Finding("/scan has a gap of 1.50 s", remedy="look at <disk>", time_ns=400_000_000),
    Finding("the stamps of /scan jitter by 8 ms", remedy="have the driver stamp"),
)
PATIENCE_S = 60.0
BUTTON = "Repair and begin again"


def test_a_refused_recording_shows_the_findings_and_a_button(show: Show, open_page: Open) -> None:
    """Each fact with its flags, in the middle of the scene; the button asks the engine to repair them."""
    failed = PlaybackStatus(state="failed", end_ns=10**9, detail="refused")
    show.engine.show(replace(room_snapshot(), playback=failed, report=SourceReport(findings=FOUND)))
    page = open_page(show.url)
    card = page.locator(".hs-findings")
    expect(card).to_contain_text("The accelerometer shows <gravity> as 986.7.")
    expect(card.locator("code").nth(1)).to_have_text("--scan-mirrored true")
    expect(page.get_by_role("button", name="Leave it as it is")).to_have_count(0)
    expect(page.locator(".hs-message")).to_be_hidden()  # it would lie over the card, and says the same
    button = page.get_by_role("button", name=BUTTON)
    box, scene = button.bounding_box(), page.locator("canvas").first.bounding_box()
    assert box is not None
    assert scene is not None
    assert scene["x"] < box["x"]
    assert box["x"] + box["width"] < scene["x"] + scene["width"]
    button.click()
    deadline = time.monotonic() + PATIENCE_S
    while not show.engine.sent and time.monotonic() < deadline:
        page.evaluate("new Promise(requestAnimationFrame)")
    assert show.engine.sent == [Repair()]
    show.engine.show(replace(room_snapshot(), report=SourceReport(repaired=FOUND)))
    expect(button).to_have_count(0)
    page.get_by_role("tab", name="Log").click()
    expect(page.locator(".hs-repaired")).to_contain_text("--imu-accel-unit mg")


def test_what_does_not_spoil_a_run_can_be_left(show: Show, open_page: Open) -> None:
    """A delay: a line over the scene, which goes for good once somebody leaves it as it is."""
    late = replace(room_snapshot(), report=SourceReport(findings=LATE))
    show.engine.show(late)
    page = open_page(show.url)
    expect(page.get_by_role("button", name=BUTTON)).to_be_visible()
    expect(page.locator(".hs-findings-line")).to_contain_text("0.11 s late")
    page.get_by_role("button", name="Leave it as it is").click()
    expect(page.locator(".hs-findings-line")).to_have_count(0)
    show.engine.show(replace(late, sequence=late.sequence + 1))
    expect(page.get_by_role("button", name=BUTTON)).to_have_count(0)
    assert not show.engine.sent


def test_what_is_wrong_with_the_recording_is_listed_and_leads_to_its_time(show: Show, open_page: Open) -> None:
    """A button asks for it; each finding has its remedy, and a click on the time goes there."""
    page = open_page(show.url)
    page.get_by_role("tab", name="Log").click()
    page.get_by_role("button", name="Examine the recording").click()
    deadline = time.monotonic() + PATIENCE_S
    while not show.engine.sent and time.monotonic() < deadline:
        page.evaluate("new Promise(requestAnimationFrame)")
    assert show.engine.sent == [Examine()]
    show.engine.show(replace(room_snapshot(), examined=WRONG))
    found = page.locator(".hs-examined li")
    expect(found).to_have_count(2)
    expect(found.first).to_contain_text("Look at <disk>.")
    found.first.get_by_role("button").click()
    while len(show.engine.sent) < 2 and time.monotonic() < deadline:
        page.evaluate("new Promise(requestAnimationFrame)")
    (sought,) = show.engine.sent[1:]
    assert isinstance(sought, Seek)
    assert abs(sought.time_ns - 400_000_000) < 1_000  # of the same time twice, the second is sent a little later
