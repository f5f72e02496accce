"""What the paper's three scenarios must reach, on the recordings that come with the program."""

import pytest

from hectorscope.cli.opening import Scene, demo_bag
from hectorscope.inputs import SourceOptions
from hectorscope.run.headless import run_headless
from hectorscope.run.metrics import metrics
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.sources import open_source


@pytest.fixture(
    scope="module", params=[("arena", 0.05), ("littoral", 0.10), ("handheld", 0.10)], ids=lambda p: p[0]
)
def finished(request: pytest.FixtureRequest) -> tuple[dict[str, object], Pipeline, float]:
    """Metrics and pipeline of a whole demo, with the largest error allowed."""
    scene: Scene
    scene, allowed = request.param
    source = open_source(str(demo_bag(scene)), SourceOptions(truth_topic="/ground_truth"))
    pipeline, effort = run_headless(source, Settings())
    return metrics(pipeline, source.report, effort), pipeline, allowed


def test_a_demo_is_followed_closely(finished: tuple[dict[str, dict[str, float]], Pipeline, float]):
    """The aligned error stays below the scenario's limit, roll and pitch within one degree rms."""
    figures, _, allowed = finished
    truth = figures["truth"]
    assert truth["aligned_rmse_m"] <= allowed
    assert truth["roll_rms_deg"] <= 1.0
    assert truth["pitch_rms_deg"] <= 1.0


def test_nearly_every_scan_of_a_demo_is_used(finished: tuple[dict[str, dict[str, float]], Pipeline, float]):
    """Only the scans before the filter is level are left out, with that reason."""
    _, pipeline, _ = finished
    assert pipeline.scans >= 0.98 * pipeline.scans_read
    assert set(pipeline.skipped) == {"scan before the attitude was known"}
