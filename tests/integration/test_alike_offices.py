"""A laser alone in offices that look alike: moments at which it was lost, or believed a wrong place."""

from dataclasses import replace
from itertools import takewhile

import numpy as np

from benchmarks.accuracy import process
from benchmarks.additions.cases import bare
from benchmarks.ensembles import varied
from hectorscope.inputs import Item
from hectorscope.run.pipeline import Pipeline
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.config import SlamConfig
from slam_core.evaluation.trajectory import Trajectory, first_on_first, interpolate, move

OFFICES = SceneOptions(scan_rate=4.7, beams=361)


def beginning(seed: int, seconds: float) -> list[Item]:
    """The scene of the ensemble, as far as it is needed."""
    items = Simulation("offices", replace(OFFICES, seed=seed)).items()
    first = next(items)
    return [first, *takewhile(lambda item: item.stamp_ns < first.stamp_ns + seconds * 1e9, items)]


def drive(variant: int, seconds: float) -> Pipeline:
    """The beginning of a variant of the ensemble."""
    items = bare(lambda seed: beginning(seed, seconds))(variant)
    return process(list(varied(items, variant)), SlamConfig())


def error_at_the_end(pipeline: Pipeline) -> float:
    """Metres, of the pose of the last scan, in the map that the first one began."""
    ours = Trajectory.from_rows(pipeline.trajectory)
    truth, covered = interpolate(Trajectory.from_rows(pipeline.truth), ours.times)
    poses, truths = ours.planar[covered], truth.planar
    away = poses - move(first_on_first(truths, poses), truths)
    return float(np.hypot(*away[-1, :2]))


def test_an_office_further_than_the_robot_can_have_come_is_no_rival():
    """It loses its pose at the door of a new office; the map explains more of the scans five metres on."""
    pipeline = drive(99, 225.0)
    assert pipeline.result is not None
    assert pipeline.result.tracking == "tracking"
    assert error_at_the_end(pipeline) < 0.1


def test_a_bad_match_beside_the_prediction_does_not_set_the_robot_in_motion():
    """At the end of a turn it slides along the corridor, and the velocity of the slide would carry it on."""
    pipeline = drive(120, 243.0)
    assert error_at_the_end(pipeline) < 0.1
