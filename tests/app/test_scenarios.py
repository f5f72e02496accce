"""The paper's three scenarios (section VI), whole, with default settings, against their exact truth."""

from typing import Any

from app.cli import Scene, demo_bag
from app.metrics import metrics
from app.runner import run_headless
from app.settings import Settings
from app.sources import SourceOptions, open_source


def figures(scene: Scene) -> dict[str, Any]:
    """What metrics.json would hold."""
    source = open_source(str(demo_bag(scene)), SourceOptions())
    pipeline, effort = run_headless(source, Settings())
    return metrics(pipeline, source.report, effort)


def check(found: dict[str, Any], metres: float) -> None:
    """Position within `metres`, roll and pitch within a degree, rms, and next to no scan lost."""
    truth = found["truth"]
    assert truth["aligned_rmse_m"] <= metres
    assert max(truth["roll_rms_deg"], truth["pitch_rms_deg"]) <= 1.0
    assert found["scans"]["used"] >= found["scans"]["read"] - 40


def test_usar() -> None:
    """A rescue arena with ramps: section VI-A."""
    check(figures("arena"), metres=0.05)


def test_littoral_waters() -> None:
    """A boat along a shore, where the water returns nothing: section VI-B."""
    check(figures("littoral"), metres=0.10)


def test_embedded_mapping_system() -> None:
    """A walk through a building that closes a large loop without loop closing: section VI-C."""
    check(figures("handheld"), metres=0.10)
