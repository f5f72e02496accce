"""Runs that begin with a saved map: to localise in, or to go on with, headless and on the page."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from hectorscope.inputs import Item, SourceError
from hectorscope.run.headless import run_headless
from hectorscope.run.map_images import map_images
from hectorscope.run.metrics import truth_errors
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.session.commands import Configure, Play, Restart, Seek
from hectorscope.session.engine import Engine
from hectorscope.session.snapshot import Snapshot
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.localization.prior_map import PriorMap, saved_levels
from slam_core.localization.tracking import FEWEST
from slam_core.measurements import Imu, LaserScan
from tests.engines import until
from tests.sources import MemoryRecording
from tests.worlds import same_map

HALF_S = 10.0


@cache
def drive(seed: int = 1) -> list[Item]:
    """Twenty seconds through the simulated rooms."""
    options = SceneOptions(seed=seed, duration=20.0, beams=361, scan_rate=20.0)
    return list(Simulation("rooms", options).items())


def half(later: bool, seed: int = 1) -> list[Item]:
    """The first or the second ten seconds."""
    begin = drive(seed)[0].stamp_ns
    return [item for item in drive(seed) if ((item.stamp_ns - begin) * 1e-9 >= HALF_S) is later]


@cache
def whole(imu: bool = True) -> Pipeline:
    """The uncut run."""
    items = [item for item in drive() if imu or not isinstance(item, Imu)]
    return run_headless(MemoryRecording(items), Settings())[0]


def run(items: list[Item], given: PriorMap, imu: bool = True) -> Pipeline:
    """A headless run that begins with a map."""
    kept = [item for item in items if imu or not isinstance(item, Imu)]
    return run_headless(MemoryRecording(kept), Settings(), prior_map=given)[0]


def saved(pipeline: Pipeline, write: bool = False, start: np.ndarray | None = None) -> PriorMap:
    """The map that a run left."""
    return PriorMap("saved", saved_levels(pipeline.slam.map), write, start)


def gap(pipeline: Pipeline, imu: bool = True) -> float:
    """Largest distance in metres to the uncut run, over the scans of both; stamps are compared."""
    shift = (pipeline.start_ns or 0) - (whole(imu).start_ns or 0)
    rows, there = pipeline.trajectory, whole(imu).trajectory
    k = np.searchsorted(there[:, 0], rows[:, 0] + shift * 1e-9 - 1e-6)
    np.testing.assert_allclose(there[k, 0], rows[:, 0] + shift * 1e-9, atol=1e-6)
    return float(np.hypot(*(rows[:, 1:3] - there[k, 1:3]).T).max())


@pytest.mark.parametrize("imu", [True, False])
def test_the_second_half_goes_on_where_the_first_ended(imu: bool):
    """Half a drive saved, the other half continues it, place unknown: within 6 cm of the uncut run all along."""
    first, _ = run_headless(MemoryRecording(half(False)), Settings())
    pipeline = run(half(True), saved(first, write=True), imu)
    assert pipeline.scans >= (180 if imu else 195)
    assert gap(pipeline, imu) < 0.06
    assert set(pipeline.states) == {"tracking"}
    errors = truth_errors(pipeline.trajectory, pipeline.truth)
    assert errors is not None
    assert errors["raw_rmse_m"] < 0.06
    assert pipeline.slam.map.updates > 0


@pytest.mark.parametrize("imu", [True, False])
def test_localising_leaves_the_map_alone(imu: bool):
    """In the map of the whole drive: within 6 cm of it all along, and not one cell changes."""
    pipeline = run(half(True), saved(whole()), imu)
    assert gap(pipeline, imu) < 0.06
    assert set(pipeline.states) == {"tracking"}
    assert pipeline.slam.map.updates == 0
    assert same_map(pipeline.slam.map, whole().slam.map)


def test_a_saved_map_tells_where_in_its_cells_the_walls_are():
    """Another drive localises nearer to the truth than by the cells alone."""
    given = saved(whole(), start=np.zeros(3))
    cells = replace(given, levels=tuple(replace(level, surfels=None) for level in given.levels))
    errors = [
        truth_errors(made.trajectory, made.truth) for made in (run(drive(2), each) for each in (given, cells))
    ]
    with_surfels, without = (each["raw_rmse_m"] for each in errors if each)
    assert with_surfels < 0.75 * without


def test_a_robot_that_leaves_the_map_is_lost_and_writes_nothing():
    """Localising in the map of half a building: degraded, then lost, behind the door to the other half."""
    first, _ = run_headless(MemoryRecording(half(False)), Settings())
    pipeline = run(half(True), saved(first))
    assert pipeline.states["lost"] > 10
    assert same_map(pipeline.slam.map, first.slam.map)


@pytest.mark.parametrize("write", [True, False])
def test_another_day_in_the_same_building(write: bool):
    """Other noise, the whole drive again, told a place a room away: found, told, and true to 6 cm."""
    pipeline = run(drive(2), saved(whole(), write, np.array([4.0, 5.0, 2.0])))
    assert gap(pipeline) < 0.06
    assert len(pipeline.notes) == 1
    assert "does not start at the given pose" in pipeline.notes[0]


def test_a_place_that_is_about_right_is_taken(monkeypatch: pytest.MonkeyPatch):
    """Half a metre and a quarter of a radian off: the whole map is never searched."""
    monkeypatch.setattr("slam_core.localization.relocalisation.GlobalSearch", None)
    row = whole().trajectory[-190]
    told = np.array([row[1] + 0.4, row[2] - 0.3, 2.0 * math.atan2(row[7], row[4]) + 0.25])
    pipeline = run(half(True), saved(whole(), start=told))
    assert gap(pipeline) < 0.06
    assert "starts at" in pipeline.notes[0]


def test_in_another_building_nothing_is_claimed():
    """A run that never finds its place says so with the remedy, and leaves neither poses nor cells."""
    elsewhere = Simulation("arena", SceneOptions(duration=5.0, beams=361, scan_rate=10.0))
    with pytest.raises(SourceError, match=r"not found in the map .*give --start X Y YAW"):
        run(list(elsewhere.items()), saved(whole(), write=True))


def noise(ranges: np.ndarray) -> np.ndarray:
    """Other ranges of the same number."""
    return np.random.default_rng(0).uniform(0.5, 9.0, len(ranges)).astype(np.float32)


def few(ranges: np.ndarray) -> np.ndarray:
    """Next to no beam returns."""
    return np.where(np.arange(len(ranges)) < FEWEST - 1, ranges, np.inf).astype(np.float32)


@pytest.mark.parametrize("seen", [noise, few])
def test_scans_before_the_place_is_known_are_counted_and_leave_nothing(seen):
    """Nothing is told at first, then the truth: no pose and no cell before, a place within the interval after."""
    items = half(True)
    blind_until = items[0].stamp_ns + 2 * 10**9
    noisy = [
        replace(item, ranges=seen(item.ranges))
        if isinstance(item, LaserScan) and item.stamp_ns < blind_until
        else item
        for item in items
    ]
    pipeline = run(noisy, saved(whole(), write=True))
    before = pipeline.skipped["scan before the robot was found in the map"]
    assert 25 < before < 70
    assert pipeline.trajectory[0, 0] >= 2.0 - 0.1
    assert gap(pipeline) < 0.06


# -------------------------------------------------------------------------------------------- the page


def test_the_page_shows_the_saved_map_before_the_first_scan_and_after_every_restart():
    """At once, unchanged to the end when localising; restart and seek begin with it and repeat the run."""
    given = saved(whole())
    reference = run(half(True), given).trajectory
    cells = [image.cells.tobytes() for image in map_images(whole().slam.map)]

    def shown(now: Snapshot) -> bool:
        return [image.cells.tobytes() for image in now.maps] == cells

    engine = Engine(MemoryRecording(half(True)), Settings(), given, autoplay=False, speed=math.inf)
    engine.start()
    try:
        waiting = until(engine, lambda now: now.playback.state == "paused")
        assert shown(waiting)
        assert (waiting.scans, waiting.mode, waiting.searching) == (0, "localise", "searching the whole map")
        engine.send(Play())
        ended = until(engine, lambda now: now.playback.state == "ended")
        assert shown(ended)
        assert ended.searching == ""
        assert sum("the robot starts at" in entry.text for entry in ended.log) == 1
        assert ended.trajectory.tobytes() == reference.tobytes()
        engine.send(Restart())
        again = until(engine, lambda now: now.epoch == 1 and now.playback.state == "ended")
        assert any("with the saved map" in entry.text for entry in again.log)
        assert again.trajectory.tobytes() == reference.tobytes()
        engine.send(Seek(half(True)[0].stamp_ns + 4 * 10**9))
        back = until(engine, lambda now: now.epoch == 2 and now.scans > 40)
        assert shown(back)
        assert back.trajectory.tobytes() == reference[: back.scans].tobytes()
    finally:
        engine.stop()


def test_settings_that_the_saved_map_cannot_follow_are_refused_in_the_log():
    """Another number of levels: a warning with what the map has, and the run goes on as it was."""
    engine = Engine(MemoryRecording(half(True)), Settings(), saved(whole()), autoplay=False)
    engine.start()
    try:
        until(engine, lambda now: now.playback.state == "paused")
        engine.send(Configure("map.levels", 2))
        warned = until(engine, lambda now: any(entry.level == "warning" for entry in now.log))
        assert "has 3 levels from 0.05 m up" in warned.log[-1].text
        assert warned.config.map.levels == 3
        assert warned.epoch == 0
    finally:
        engine.stop()
