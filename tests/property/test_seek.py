"""After any seeks and changes of settings, the run is what a straight run would be."""

import math
import random

import pytest

from hectorscope.inputs import Item
from hectorscope.run.map_images import map_images
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.run.warmup import load_everything
from hectorscope.session.commands import Configure, Play, Restart, Seek, StepBack, StepScan, Undo
from hectorscope.session.snapshot import Snapshot
from hectorscope.simulation import SceneOptions, Simulation
from slam_core.measurements import LaserScan
from tests.cases import quick_first
from tests.engines import START, after, running, state, until
from tests.sources import MemoryRecording

CHOICES: dict[str, tuple[float, float]] = {"fusion.omega": (0.1, 0.9), "map.factor_occupied": (0.6, 0.9)}


@pytest.fixture(scope="module")
def drive() -> list[Item]:
    """Fifteen seconds with three hundred scans: six checkpoints; nobody waits for kernels meanwhile."""
    load_everything()
    return list(Simulation("rooms", SceneOptions(duration=15.0, scan_rate=20.0, beams=91)).items())


def straight(drive: list[Item], settings: Settings, scans: int) -> Pipeline:
    """A run from the beginning up to so many results."""
    pipeline = Pipeline(settings, drive[0].stamp_ns)
    for item in drive:
        for measurement in pipeline.admit(item):
            if pipeline.scans == scans and isinstance(measurement, LaserScan):
                return pipeline
            pipeline.step(measurement)
    for measurement in pipeline.flush():
        pipeline.step(measurement)
    return pipeline


def check(shown: Snapshot, drive: list[Item], settings: Settings) -> None:
    """Poses, rows, and the picture of every level."""
    expected = straight(drive, settings, shown.scans)
    assert shown.playback.time_ns == expected.time_ns
    assert shown.trajectory.tobytes() == expected.trajectory.tobytes()
    assert shown.navigation.tobytes() == expected.navigation[: len(shown.navigation)].tobytes()
    assert shown.map_updates == expected.slam.map.updates
    pictures = zip(shown.maps, map_images(expected.slam.map, 0), strict=True)
    for here, there in pictures:
        assert here.cells.tobytes() == there.cells.tobytes()
        assert here.surfels.tobytes() == there.surfels.tobytes()
    assert expected.result is not None and shown.result is not None
    assert shown.result.T_map_base.translation.tobytes() == expected.result.T_map_base.translation.tobytes()


@pytest.mark.parametrize("seed", quick_first(range(4), 2))
def test_random_seeks_with_changed_settings_give_the_bytes_of_a_straight_run(drive: list[Item], seed: int):
    """Back and forth over what was passed, with changes at rest that fork the run."""
    chance, settings = random.Random(seed), START
    begin, end = drive[0].stamp_ns, drive[-1].stamp_ns
    with running(MemoryRecording(drive), settings, speed=math.inf) as engine:
        until(engine, state("ended"))
        for turn in range(12):
            shown = after(engine, Seek(chance.randint(begin + 10**9, end)))
            check(shown, drive, settings)
            if turn % 4 == 3:
                name = chance.choice(list(CHOICES))
                value = round(chance.uniform(*CHOICES[name]), 3)
                at_ns = shown.playback.time_ns + (shown.playback.state == "ended")
                settings = settings.changed(at_ns, name, value)
                check(after(engine, Configure(name, value)), drive, settings)
        after(engine, Seek(begin + 2 * 10**9))
        engine.send(Play())
        check(until(engine, state("ended")), drive, settings)


@pytest.mark.parametrize("seed", quick_first(range(3)))
def test_random_seeks_behind_what_was_run_ahead_give_the_bytes_of_a_straight_run(drive: list[Item], seed: int):
    """Nothing of it was shown before; a change at rest gives up what is known behind it, and that is run again."""
    chance, settings = random.Random(seed), START
    begin, end = drive[0].stamp_ns, drive[-1].stamp_ns
    with running(MemoryRecording(drive), settings, autoplay=False) as engine:
        for turn in range(9):
            if turn != 5:  # once it is not waited for
                until(engine, lambda now: now.obeyed == engine.sent and now.ahead.whole)
            shown = after(engine, Seek(chance.randint(begin + 10**9, end - 10**9)))
            check(shown, drive, settings)
            if turn % 3 == 1:
                name = chance.choice(list(CHOICES))
                value = round(chance.uniform(*CHOICES[name]), 3)
                settings = settings.changed(shown.playback.time_ns, name, value)
                check(after(engine, Configure(name, value)), drive, settings)


def test_a_run_that_is_brought_back_can_be_sought_in(drive: list[Item]):
    """Its checkpoints were given up for the run that took its place: it is the same without them."""
    with running(MemoryRecording(drive), speed=math.inf) as engine:
        until(engine, state("ended"))
        after(engine, Restart(), Undo())
        for share in (0.5, 0.9, 0.2):
            shown = after(engine, Seek(drive[0].stamp_ns + round(share * 15e9)))
            check(shown, drive, START)


def test_steps_back_show_each_scan_as_it_was(drive: list[Item]):
    """From the end and from a pause, one scan each; before the first scan there is none."""
    with running(MemoryRecording(drive), speed=math.inf) as engine:
        ended = until(engine, state("ended"))
        for back in range(1, 6):
            shown = after(engine, StepBack())
            assert (shown.scans, shown.playback.state) == (ended.scans - back, "paused")
            check(shown, drive, START)
        after(engine, Seek(drive[0].stamp_ns))
        first = after(engine, StepScan())
        while first.scans < 1:
            first = after(engine, StepScan())
        assert after(engine, StepBack()).scans == 1


def test_a_seek_reads_and_steps_from_the_nearest_checkpoint_only(drive: list[Item]):
    """The source begins behind most of the items; without a budget the run begins again."""
    begun: dict[int, list[int]] = {}
    for budget in (512, 0):
        source = Counting(drive)
        with running(source, speed=math.inf, checkpoints=budget) as engine:
            until(engine, state("ended"))
            shown = after(engine, Seek(drive[0].stamp_ns + 14 * 10**9))
            check(shown, drive, START)
        begun[budget] = source.begun
    assert begun[512][-1] > len(drive) // 2
    assert begun[0] == [0, 0, 0]  # what is shown, twice, and what runs ahead of it


class Counting(MemoryRecording):
    """Tells behind how many items each reading began."""

    def __init__(self, items: list[Item]) -> None:
        super().__init__(items)
        self.begun: list[int] = []

    def _after(self, skip: int):  # type: ignore[no-untyped-def]
        self.begun.append(skip)
        return super()._after(skip)
