"""Real recordings through the whole pipeline with default settings, against what is known of them."""

from pathlib import Path

import pytest

from app.metrics import metrics
from app.pipeline import Pipeline
from app.runner import run_headless
from app.settings import Settings
from app.snapshot import SourceReport
from app.sources import SourceOptions, open_source
from slam_core.config import SlamConfig, with_value

pytestmark = pytest.mark.real
JACKAL = "jackal_vicon/test_2026-02-17-15-54-31"


def run(path: Path, config: SlamConfig | None = None) -> tuple[Pipeline, dict[str, float], int]:
    """The finished pipeline, its errors against the truth, and the number of occupied cells."""
    pipeline, effort = run_headless(open_source(str(path), SourceOptions()), Settings(config or SlamConfig()))
    figures = metrics(pipeline, SourceReport(), effort)
    return pipeline, figures["truth"], figures["occupied_cells"]


def test_jackal_against_motion_capture(recordings: Path) -> None:
    """A wheeled robot in a small room: 2 cm, and the same bytes from each of three containers."""
    pipeline, errors, _ = run(recordings / f"{JACKAL}.bag")
    assert errors["aligned_rmse_m"] <= 0.020
    for other in (JACKAL, f"{JACKAL}_mcap"):
        assert run(recordings / other)[0].trajectory.tobytes() == pipeline.trajectory.tobytes()


def test_jarvis_with_its_mount(recordings: Path) -> None:
    """A laser away from the base, by tf: 4 cm against reflectors."""
    _, errors, _ = run(recordings / "jarvis_nav350" / "jarvis_circular_path_fast.bag")
    assert errors["aligned_rmse_m"] <= 0.04


def test_stabilisation_cleans_the_map_of_a_tilting_laser(recordings: Path) -> None:
    """A scanner swung by hand: with the attitude from tf the map has at least 15 % fewer occupied cells."""
    bag = recordings / "ccny_tilted_handheld" / "demo_v2.bag"
    stabilised = run(bag)[2]
    flat = run(bag, with_value(SlamConfig(), "scan.stabilise", False))[2]
    assert 0 < stabilised <= 0.85 * flat
