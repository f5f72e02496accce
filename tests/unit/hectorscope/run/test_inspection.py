"""A closer look at beams and cells, against a run of which all is known."""

import math
from copy import copy

import numpy as np
import pytest

from benchmarks.additions.faults import noisy
from hectorscope.run.cell_history import cell_history
from hectorscope.run.checkpoints import Checkpoints, Place
from hectorscope.run.inspection import nearest_beam, target_at, view_of
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.readings import BeamTarget, BeamView, CellTarget, CellView
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.geometry import transform_points
from slam_core.measurements import LaserScan
from tests.engines import START

EVERY = 20  # scans between checkpoints
CELL = (2.0, 0.0)


@pytest.fixture(scope="module")
def driven() -> tuple[Pipeline, Checkpoints, dict[int, Pipeline]]:
    """A drive through the rooms, with checkpoints, and the log-odds of every level after each scan."""
    pipeline, kept, maps = Pipeline(START), Checkpoints(), {}
    for item in Simulation("rooms", SceneOptions(duration=12.0, scan_rate=10.0, beams=181)).items():
        for measurement in pipeline.admit(item):
            result = pipeline.step(measurement)
            if isinstance(measurement, LaserScan) and result is not None:
                maps[pipeline.scans] = pipeline.slam.map.copy()
                if pipeline.scans % EVERY == 0:
                    kept.add(pipeline, Place(pipeline.scans, None))
    return pipeline, kept, maps


def value(tiled, level, cell) -> float:
    column, row = cell
    return float(tiled.gather(level, (row, row + 1, column, column + 1)).item())


def test_a_smoothed_beam_has_its_range_as_measured_too() -> None:
    """Of a laser with a noise of 1 %: the one that came with the scan, and the one that its endpoint is at."""
    pipeline, measured = Pipeline(START), np.empty(0, np.float32)
    items = list(Simulation("rooms", SceneOptions(duration=8.0, scan_rate=10.0, beams=721)).items())
    for item in noisy(0.01)(items, 1):
        if isinstance(item, LaserScan):
            measured = item.ranges
        for measurement in pipeline.admit(item):
            pipeline.step(measurement)
    views = [view_of(BeamTarget(number), pipeline, Checkpoints()) for number in range(0, 721, 20)]
    beams = [view for view in views if isinstance(view, BeamView) and view.end is not None]
    assert all(view.range_m == measured[view.number] for view in beams)
    assert sum(view.used_m != view.range_m for view in beams) > 5


def test_a_beam_is_found_at_its_endpoint_with_its_figures(driven) -> None:
    """Its number by the place, and by the number the range, the angle and the residual that the match had."""
    pipeline, kept, _ = driven
    result = pipeline.result
    ends = transform_points(result.planar, result.points)
    for k in (0, len(ends) // 3, len(ends) - 1):
        target = target_at([CellTarget(0, *ends[k])], 0.01, result, pipeline.slam.map)
        assert isinstance(target, BeamTarget)
        view = view_of(target, pipeline, kept)
        assert isinstance(view, BeamView)
        scan = result.sweep.scan
        assert view.range_m == view.used_m == scan.ranges[view.number]
        assert view.angle == pytest.approx(scan.angle_min + view.number * scan.angle_increment)
        assert view.residual == result.match.residuals[k]
        assert (view.end.x, view.end.y) == pytest.approx(tuple(ends[k]))
        away = math.hypot(view.end.x - view.laser[0], view.end.y - view.laser[1])
        assert away == pytest.approx(view.range_m, abs=0.05)


def test_a_beam_tells_whether_the_match_did_without_it(driven) -> None:
    """By its number among the endpoints, which are fewer than the beams."""
    pipeline, kept, _ = driven
    other = copy(pipeline)
    match = pipeline.result.match._replace(left_out=np.array([3, 5]))
    other.result = pipeline.result._replace(match=match)
    ends = transform_points(pipeline.result.planar, pipeline.result.points)
    for k in range(2, 7):
        target = target_at([CellTarget(0, *ends[k])], 0.01, pipeline.result, pipeline.slam.map)
        assert view_of(target, other, kept).left_out == (k in {3, 5})
        assert not view_of(target, pipeline, kept).left_out


def test_a_place_without_a_beam_is_a_cell_of_the_first_known_level(driven) -> None:
    """Beams count within reach only; unknown cells of nearer levels are looked through."""
    pipeline, _, _ = driven
    tiled, result = pipeline.slam.map, pipeline.result
    far = CellTarget(2, 400.0, 400.0)
    near = CellTarget(0, *transform_points(result.planar, np.zeros((1, 2)))[0])
    assert nearest_beam(result, near, 0.01) is None
    assert target_at([far, near], 0.01, result, tiled) == near
    assert target_at([far], 0.01, result, tiled) is None


def test_a_cell_has_its_probability_on_every_level(driven) -> None:
    """The same as the map gives for the cells of that place."""
    pipeline, kept, _ = driven
    view = view_of(CellTarget(1, *CELL), pipeline, kept)
    assert isinstance(view, CellView)
    for i, reading in enumerate(view.levels):
        whole = pipeline.slam.map.whole(i)
        u, v = whole.cell_of(*CELL)
        assert reading.probability == pytest.approx(float(whole.probability[v, u]), abs=2e-4)


def test_the_times_of_a_cell_hold_what_really_happened(driven) -> None:
    """The true first and last scan that changed it lie in the spans, which are at most a checkpoint wide."""
    pipeline, kept, maps = driven
    rng, checked = np.random.default_rng(1), 0
    row0, row1, column0, column1 = pipeline.slam.map.bounds(0)
    for _ in range(400):
        cell = int(rng.integers(column0, column1)), int(rng.integers(row0, row1))
        history = cell_history(pipeline, kept, 0, cell)
        values = [0.0, *(value(maps[n], 0, cell) for n in sorted(maps))]
        if values[-1] == 0.0:
            assert history.first is None
            continue
        first = next(n for n, v in enumerate(values) if v)
        last = max(n for n in range(1, len(values)) if values[n] != values[n - 1])
        assert history.first.first <= first <= history.first.last
        assert history.last.first <= last <= history.last.last
        assert history.last.last - history.last.first < EVERY
        assert history.first.from_s == pipeline.trajectory[history.first.first - 1, 0]
        checked += 1
    assert checked > 100
