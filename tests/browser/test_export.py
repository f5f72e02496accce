"""What a browser takes with it from a real run: archives, a picture in another size, a video."""

import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from PIL import Image
from playwright.sync_api import Download, Page, expect

from hectorscope.session.engine import Engine
from hectorscope.simulation import SceneOptions, Simulation
from hectorscope.web.server import PageServer
from tests.browser.conftest import Open
from tests.engines import running, until
from tests.sources import MemoryRecording

pytestmark = pytest.mark.browser
SIZE = "[window.__viserMutable.canvas.width, window.__viserMutable.canvas.height]"
COUNT = """() => {
  window.framesDrawn = 0;
  window.hectorscope.drawing.push(() => (window.framesDrawn += 1));
}"""


@pytest.fixture(scope="module")
def engine() -> Iterator[Engine]:
    """At rest at the end of a short drive."""
    drive = list(Simulation("rooms", SceneOptions(duration=6.0, scan_rate=10.0, beams=181)).items())
    with running(MemoryRecording(drive), speed=float("inf")) as made:
        until(made, lambda now: now.playback.state == "ended", 60.0)
        yield made


@pytest.fixture
def page(engine: Engine, open_page: Open) -> Iterator[Page]:
    """With the tab of the exports."""
    server = PageServer(engine, port=0)
    server.start()
    made = open_page(server.url)
    made.get_by_role("tab", name="Export").click()
    yield made
    server.stop()


def pressed(page: Page, name: str) -> Download:
    with page.expect_download() as download:
        page.get_by_role("button", name=name).click()
    return download.value


def test_chosen_formats_come_as_one_archive(page: Page, engine: Engine, tmp_path: Path) -> None:
    """Also those that need the recording once more; the notes stand in the replay, at the time that was shown."""
    for box in page.locator("[data-hs-format]").all():
        box.set_checked(box.get_attribute("data-hs-format") in ("tum", "csv", "html"))
    page.get_by_label("Note at the shown time").fill("the <end>")
    page.wait_for_function("window.hectorscope.plotted().tables.series?.count > 0")
    page.get_by_role("button", name="Pin the note to this time").click()
    expect(page.locator("[data-hs-notes] li")).to_contain_text("the <end>")
    download = pressed(page, "Download the results so far")
    assert download.suggested_filename == "memory.zip"
    download.save_as(tmp_path / "run.zip")
    archive = zipfile.ZipFile(tmp_path / "run.zip")
    assert archive.namelist() == ["replay.html", "series.csv", "trajectory.tum"]
    latest = engine.mailbox.latest
    assert latest is not None
    rows = archive.read("series.csv").decode().splitlines()
    assert len(rows) == 1 + latest.scans
    assert len(archive.read("trajectory.tum").decode().splitlines()) == latest.scans
    assert "the \\u003cend>" in archive.read("replay.html").decode()


@pytest.mark.slow
def test_many_long_notes_are_kept(page: Page, tmp_path: Path) -> None:
    """As many and as long as the form takes: none gets lost on its way to the server."""
    for box in page.locator("[data-hs-format]").all():
        box.set_checked(box.get_attribute("data-hs-format") == "html")
    page.evaluate("""for (let at = 0; at < 100; at += 1)
      window.hectorscope.exporting.notes.push([at / 10, `note ${at} ` + "ö".repeat(490)])""")
    pressed(page, "Download the results so far").save_as(tmp_path / "run.zip")
    replay = zipfile.ZipFile(tmp_path / "run.zip").read("replay.html").decode()
    assert all(f"note {number} " in replay for number in range(100))


def test_a_picture_has_the_size_that_was_chosen(page: Page, tmp_path: Path) -> None:
    """The scene is drawn in it, not enlarged, and has its own size again afterwards."""
    before = page.evaluate(SIZE)
    page.get_by_label("Size of the picture").select_option("1920x1080")
    pressed(page, "Save a picture").save_as(tmp_path / "picture.png")
    picture = Image.open(tmp_path / "picture.png").convert("L")
    assert picture.size == (1920, 1080)
    low, high = picture.getextrema()
    assert high - low > 100  # type: ignore[operator]
    page.wait_for_function(
        "([w, h]) => window.__viserMutable.canvas.width === w && window.__viserMutable.canvas.height === h",
        arg=before,
    )


@pytest.mark.slow
def test_a_video_of_the_scene_plays(page: Page, tmp_path: Path) -> None:
    """It is a file that a browser plays, as large as the scene."""
    page.get_by_role("button", name="Record a video").click()
    page.evaluate(COUNT)
    page.wait_for_function("window.framesDrawn > 20")
    download = pressed(page, "End the video and save it")
    assert download.suggested_filename.startswith("hectorscope.")
    download.save_as(tmp_path / download.suggested_filename)
    size = page.evaluate(SIZE)
    content = list((tmp_path / download.suggested_filename).read_bytes())
    elsewhere = page.context.new_page()  # our page itself may play no videos
    played = elsewhere.evaluate(
        """async (bytes) => {
          const video = document.createElement('video');
          video.src = URL.createObjectURL(new Blob([new Uint8Array(bytes)]));
          await new Promise((done, failed) => { video.onloadeddata = done; video.onerror = failed; });
          return [video.videoWidth, video.videoHeight];
        }""",
        content,
    )
    assert played == pytest.approx(size, abs=1)
