"""Another recording is opened from the page: from the list of the server, or by dropping a file onto it."""

import base64
import itertools
import re
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest
from playwright.sync_api import Page, WebSocketRoute, expect

from tests.bags import small_run
from tests.browser.conftest import LISTED, UPLOADS, Open, Opened
from tests.engines import state, until
from tests.ros_messages import Messages, write_bag

pytestmark = pytest.mark.browser

PATIENCE_S = 120.0
# What a hand does that lets a file go over the page.
DROP = """([name, base64]) => {
  const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  const carried = new DataTransfer();
  carried.items.add(new File([bytes], name));
  for (const kind of ['dragover', 'drop'])
    document.body.dispatchEvent(new DragEvent(kind, { dataTransfer: carried, bubbles: true, cancelable: true }));
}"""


def drop(page: Page, name: str, content: bytes) -> None:
    """Let a file go over the page."""
    page.evaluate(DROP, [name, base64.b64encode(content).decode()])


def drop_from_disk(page: Page, path: Path) -> None:
    """As a hand drops a file or folder of the disk: it moves on until the page shows that it takes what comes."""
    session = page.context.new_cdp_session(page)
    data = {"items": [], "files": [str(path)], "dragOperationsMask": 1}

    def drag(kind: str, x: int) -> None:
        session.send("Input.dispatchDragEvent", {"type": kind, "x": x, "y": 300, "data": data})

    drag("dragEnter", 300)
    taken, deadline = page.locator("html.hs-dropping"), time.monotonic() + PATIENCE_S
    for x in itertools.cycle((300, 301)):
        drag("dragOver", x)
        if taken.count():
            break
        assert time.monotonic() < deadline, "the page does not show that it takes what is dragged over it"
    drag("drop", x)
    expect(taken).to_have_count(0)


def test_a_folder_that_is_dropped_is_opened(opened: Opened, open_page: Open, tmp_path: Path) -> None:
    """A rosbag2 folder, under its own name; what is in its metadata.yaml is not looked at."""
    bag = write_bag(tmp_path / "drive", small_run(Messages(), 80))
    (bag / "metadata.yaml").write_text("rosbag2_bagfile_information: {relative_file_paths: [/etc/passwd]}")
    page = open_page(opened.server.url, LISTED)
    drop_from_disk(page, bag)
    now = until(opened.engine, lambda now: now.source == "drive" and now.scans, PATIENCE_S)
    assert not any("metadata" in line.text for line in now.log)
    expect(page.locator(".hs-recordings")).to_be_hidden()


def test_a_folder_without_messages_is_refused_in_the_page(opened: Opened, open_page: Open, tmp_path: Path) -> None:
    """Before anything is sent."""
    (tmp_path / "pictures").mkdir()
    (tmp_path / "pictures" / "a.png").write_bytes(b"x")
    page = open_page(opened.server.url, LISTED)
    drop_from_disk(page, tmp_path / "pictures")
    told = page.locator(".hs-recordings-status")
    expect(told).to_have_text("pictures is no rosbag2 folder: it has no .mcap and no .db3 file.")


def test_a_recording_is_chosen_from_the_list(opened: Opened, open_page: Open) -> None:
    """The empty page offers the list, with names as they are; the one that is clicked runs for every browser."""
    page, other = (open_page(opened.server.url, LISTED) for _ in range(2))
    page.get_by_role("button", name="Open a recording", exact=True).click()
    listed = page.locator(".hs-recordings-list button")
    expect(listed).to_have_text(["<b>hall<b>.bag", "kitchen.bag"])
    page.get_by_role("searchbox", name="Find a recording").fill("hall")
    expect(listed).to_have_count(1)
    listed.click()
    until(opened.engine, lambda now: now.source == "<b>hall<b>.bag" and now.scans, PATIENCE_S)
    for each in (page, other):
        expect(each.locator(".hs-source")).to_have_text("<b>hall<b>.bag")
        each.wait_for_function("!!window.__viserMutable.nodeRefFromName['/floor/map/level0']")
    expect(page.locator(".hs-recordings")).to_be_hidden()


def test_a_new_recording_is_in_the_list_when_it_is_opened(opened: Opened, open_page: Open, bags: Path) -> None:
    """By the key O; the folder is looked at anew."""
    page = open_page(opened.server.url, LISTED)
    new = bags / "new.bag"
    new.write_bytes((bags / "kitchen.bag").read_bytes())
    try:
        page.locator("body").press("o")
        expect(page.locator(".hs-recordings-list button", has_text="new.bag")).to_be_visible()
    finally:
        new.unlink()


def test_a_file_that_is_dropped_is_opened(opened: Opened, open_page: Open, bags: Path) -> None:
    """Under its own name, with the same result as from the folder; then it is in the list."""
    page = open_page(opened.server.url, LISTED)
    drop(page, "mine.bag", (bags / "kitchen.bag").read_bytes())
    ended = state("ended")
    shown = until(opened.engine, lambda now: now.source == "mine.bag" and ended(now), PATIENCE_S)
    expect(page.locator(".hs-source")).to_have_text("mine.bag")
    expect(page.locator(".hs-recordings")).to_be_hidden()
    assert shown.scans > 30
    assert "mine.bag" in [each.name for each in shown.library]


def test_a_folder_that_is_dropped_during_an_upload_leaves_it_alone(
    opened: Opened, open_page: Open, bags: Path, tmp_path: Path
) -> None:
    """The dialogue tells of the upload alone, which the server hears of late, and the file is opened."""
    (tmp_path / "pictures").mkdir()
    page = open_page(opened.server.url, LISTED)
    late: list[Callable[[], None]] = []

    def hold_back(sender: WebSocketRoute) -> None:
        server = sender.connect_to_server()
        sender.on_message(lambda sent: server.send(sent) if late else late.append(partial(server.send, sent)))

    page.route_web_socket(re.compile("/upload$"), hold_back)
    page.reload()
    page.wait_for_function(LISTED)
    drop(page, "late.bag", (bags / "kitchen.bag").read_bytes())
    told = page.locator(".hs-recordings-status")
    expect(told).to_have_text("Sending late.bag")
    drop_from_disk(page, tmp_path / "pictures")
    expect(told).to_have_text("Sending late.bag")
    expect(page.locator(".hs-recordings progress")).to_be_visible()
    late[0]()
    expect(page.locator(".hs-recordings")).to_be_hidden()
    until(opened.engine, lambda now: now.source == "late.bag" and now.scans, PATIENCE_S)


@pytest.mark.parametrize(
    ("name", "content", "reason"),
    [
        ("huge.bag", bytes(UPLOADS + 1), "huge.bag has 8.0 MiB, and 8.0 MiB of 8.0 MiB are left"),
        ("notes.txt", b"words", "notes.txt is no recording by its name"),
    ],
)
def test_a_file_that_is_not_taken_is_refused_in_words(
    opened: Opened, open_page: Open, name: str, content: bytes, reason: str
) -> None:
    """In the dialogue, which stays open; nothing else changes, and another file can be dropped."""
    page = open_page(opened.server.url, LISTED)
    drop(page, name, content)
    status = page.locator(".hs-recordings-status")
    expect(status).to_contain_text(reason)
    expect(page.locator(".hs-recordings")).to_be_visible()
    drop(page, "broken.bag", b"nothing of use")
    until(opened.engine, lambda now: any("broken.bag" in entry.text for entry in now.log), PATIENCE_S)
    assert opened.engine.mailbox.latest is not None
    assert opened.engine.mailbox.latest.playback.state == "empty"
