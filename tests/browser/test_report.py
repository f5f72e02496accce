"""The report of a run in a real browser, from the disk."""

import io
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Browser, expect

from hectorscope.exporters import chosen, run
from hectorscope.simulation import SceneOptions, Simulation
from tests.engines import START
from tests.sources import MemoryRecording

TRAJECTORY, WALL = (94, 60, 153), (24, 32, 44)


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Of a drive of some metres through the rooms."""
    folder = tmp_path_factory.mktemp("report")
    drive = list(Simulation("rooms", SceneOptions(duration=12.0, scan_rate=10.0, beams=181)).items())
    run(MemoryRecording(drive), START, folder, truth=None, progress=lambda _: None, formats=chosen("report"))
    return folder / "report.html"


def test_the_report_draws_map_trajectory_and_curves_without_a_network(browser: Browser, report: Path):
    """Every part is to be seen, in its colours; the page asks for nothing but itself and says no error."""
    page = browser.new_page(viewport={"width": 1000, "height": 900})
    asked, said = [], []
    page.on("request", lambda request: asked.append(request.url))
    page.on("console", lambda message: said.append(message.text))
    page.goto(report.as_uri())
    assert [url for url in asked if not url.startswith("data:")] == [report.as_uri()]
    expect(page.get_by_role("heading", name="Map and trajectory")).to_be_visible()
    expect(page.locator("svg.chart")).to_have_count(5)
    for curve in page.locator("svg.chart path.line").all():
        box = curve.bounding_box()
        assert box is not None
        assert box["width"] > 500
    picture = Image.open(io.BytesIO(page.locator("svg.map").screenshot())).convert("RGB")
    pixels = np.asarray(picture, np.int64).reshape(-1, 3)
    for colour in (TRAJECTORY, WALL, (255, 255, 255)):
        off = np.abs(pixels - colour).max(axis=1)  # the edges of a line are blended
        assert np.count_nonzero(off < 40) > 100
    assert not said
    page.close()


def test_the_report_fits_small_windows_and_paper(browser: Browser, report: Path):
    """Nothing reaches over the side of a phone, and it prints on some pages."""
    page = browser.new_page(viewport={"width": 390, "height": 800})
    page.goto(report.as_uri())
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert page.pdf(format="A4").startswith(b"%PDF")
    page.close()
