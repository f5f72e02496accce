"""Checkpoints of a pipeline: what they bring back, share and give up."""

import numpy as np
import pytest

from hectorscope.inputs import Item
from hectorscope.run.checkpoints import Checkpoints, Place
from hectorscope.run.pipeline import Pipeline
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.measurements import LaserScan
from tests.engines import START
from tests.worlds import same_map


@pytest.fixture(scope="module")
def drive() -> list[Item]:
    return list(Simulation("rooms", SceneOptions(duration=4.0, scan_rate=20.0, beams=181)).items())


def run(pipeline: Pipeline, items: list[Item], kept: Checkpoints | None = None, taken: int = 0) -> Pipeline:
    """Step through items; a place behind every eighth scan."""
    scans = 0
    for number, item in enumerate(items, taken + 1):
        for measurement in pipeline.admit(item):
            pipeline.step(measurement)
        scans += isinstance(item, LaserScan)
        if kept is not None and isinstance(item, LaserScan) and scans % 8 == 0:
            kept.add(pipeline, Place(number, None))
    return pipeline


def test_a_run_goes_on_from_a_checkpoint_to_the_same_bytes(drive: list[Item]):
    """Rows and map, from every checkpoint, twice, while the run that left them has gone on."""
    kept = Checkpoints()
    straight = run(Pipeline(START), drive, kept)
    assert len(kept) >= 8
    for time_ns in np.linspace(drive[0].stamp_ns + 10**9, drive[-1].stamp_ns, 8).astype(np.int64).tolist() * 2:
        checkpoint = kept.before(time_ns)
        assert checkpoint is not None
        taken = checkpoint.place.taken
        again = checkpoint.pipeline(START)
        assert again.trajectory.tobytes() == straight.trajectory[: again.scans].tobytes()
        run(again, drive[taken:])
        for rows in ("trajectory", "navigation", "truth", "truth_in_map"):
            assert getattr(again, rows).tobytes() == getattr(straight, rows).tobytes()
        assert same_map(again.slam.map, straight.slam.map)
        assert again.slam.map.changed_since(40) == straight.slam.map.changed_since(40)


def test_tiles_that_did_not_change_are_shared(drive: list[Item]):
    """All checkpoints together take less than each by itself."""
    kept = Checkpoints()
    pipeline = run(Pipeline(START), drive, kept)
    alone = sum(kept.before(t).nbytes() for t in (pipeline.time_ns,)) * len(kept)  # type: ignore[union-attr]
    assert kept.nbytes < alone


def test_a_full_budget_thins_them_out_evenly(drive: list[Item]):
    """They stay within it, over the whole run, and the oldest is not the one that goes."""
    free = Checkpoints()
    run(Pipeline(START), drive, free)
    tight = Checkpoints(3 * free.nbytes // 4)
    pipeline = run(Pipeline(START), drive, tight)
    assert 1 < len(tight) < len(free)
    assert tight.nbytes <= 3 * free.nbytes // 4
    early, late = tight.before(drive[0].stamp_ns + 2 * 10**9), tight.before(pipeline.time_ns)
    assert early is not None and late is not None
    assert early.place.taken < late.place.taken


def test_no_budget_keeps_none(drive: list[Item]):
    """0 turns them off."""
    kept = Checkpoints(0)
    run(Pipeline(START), drive, kept)
    assert len(kept) == 0


def test_those_behind_a_change_are_forgotten(drive: list[Item]):
    """They belong to a run that is not the shown one any more; those before stay."""
    kept = Checkpoints()
    pipeline = run(Pipeline(START), drive, kept)
    middle_ns = drive[0].stamp_ns + 2 * 10**9
    before = kept.before(middle_ns)
    kept.forget_from(middle_ns)
    last = kept.before(pipeline.time_ns)
    assert last is not None and before is not None
    assert before.time_ns <= last.time_ns < middle_ns


def test_a_place_that_was_kept_is_not_kept_again(drive: list[Item]):
    """A run that goes on from a checkpoint passes the same places."""
    kept = Checkpoints()
    run(Pipeline(START), drive, kept)
    count, size = len(kept), kept.nbytes
    run(Pipeline(START), drive, kept)
    assert (len(kept), kept.nbytes) == (count, size)
