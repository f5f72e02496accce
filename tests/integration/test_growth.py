"""A map that grows or stops growing, through engine, files and figures."""

import math
import time
from pathlib import Path

import numpy as np
import pytest

from hectorscope.exporters import export, prepare
from hectorscope.inputs import Item, SourceReport
from hectorscope.run.headless import run_headless
from hectorscope.run.map_images import map_images
from hectorscope.run.metrics import metrics
from hectorscope.run.settings import Settings
from hectorscope.session.engine import Engine
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.config import MapConfig, SlamConfig
from tests.sources import MemoryRecording

PATIENCE_S = 20.0
CROWDED = Settings(SlamConfig(map=MapConfig(resolution=0.02, size=64, limit=1.0)))


@pytest.fixture(scope="module")
def drive() -> list[Item]:
    """Four seconds through the simulated rooms, with inertial data and truth."""
    return list(Simulation("rooms", SceneOptions(duration=4.0, scan_rate=20.0, beams=181)).items())


def test_results_do_not_depend_on_the_size_at_the_start(drive: list[Item], tmp_path: Path):
    """From 128 cells or from 2048: images of all levels, exported map and trajectory are the same bytes."""
    images = []
    for size in (128, 2048):
        settings = Settings(SlamConfig(map=MapConfig(size=size)))
        pipeline, effort = run_headless(MemoryRecording(drive), settings)
        assert (pipeline.slam.map.levels[0].shape == (size, size)) is (size == 2048)
        folder = tmp_path / str(size)
        prepare(folder)
        export(pipeline, metrics(pipeline, SourceReport(), effort), folder)
        images.append(map_images(pipeline.slam.map))
    for name in ("map.pgm", "map.yaml", "trajectory.tum"):
        assert (tmp_path / "128" / name).read_bytes() == (tmp_path / "2048" / name).read_bytes()
    for a, b in zip(*images, strict=True):
        assert (a.x, a.y) == (b.x, b.y)
        np.testing.assert_array_equal(a.cells, b.cells)


def test_a_full_map_is_logged_once_as_a_warning(drive: list[Item]):
    """The page's log says at which limit the map stopped and what to do, once, and the run goes on to its end."""
    engine = Engine(MemoryRecording(drive), CROWDED, speed=math.inf)
    engine.start()
    try:
        deadline = time.monotonic() + PATIENCE_S
        latest = engine.mailbox.latest
        while (latest is None or latest.playback.state != "ended") and time.monotonic() < deadline:
            latest = engine.mailbox.take(timeout=0.1) or latest
    finally:
        engine.stop()
    assert latest is not None
    assert latest.playback.state == "ended"
    warnings = [entry.text for entry in latest.log if entry.level == "warning" and "map.limit" in entry.text]
    assert len(warnings) == 1
    assert "limit of 1 MB: raise map.limit" in warnings[0]


def test_a_full_map_is_among_the_figures(drive: list[Item]):
    """The headless run leaves the same sentence in metrics.json; a map that had room leaves none."""
    for settings, expected in ((CROWDED, 1), (Settings(), 0)):
        source = MemoryRecording(drive)
        pipeline, effort = run_headless(source, settings)
        notes = metrics(pipeline, source.report, effort)["notes"]
        assert sum("map.limit" in note for note in notes) == expected
