"""Settings changed while the engine runs: from when on they act, and what is refused."""

import math
from dataclasses import replace

import numpy as np
import pytest

from hectorscope.inputs import Item
from hectorscope.run.headless import run_headless
from hectorscope.run.settings import Change, Settings
from hectorscope.session.commands import Command, Configure, ConfigureAll, Pause, Play, Seek, SetSpeed, StepScan
from slam_core.config import PRESETS, nearest_preset, with_value, with_values
from tests.engines import START, after, running, state, until
from tests.sources import MemoryRecording


def test_a_change_at_rest_processes_the_shown_scan_again(drive: list[Item], reference: np.ndarray):
    """What it does is seen at once, the past stays, the future follows from it, and the log says what and when."""
    with running(MemoryRecording(drive), autoplay=False, speed=math.inf) as engine:
        until(engine, state("paused"))
        there = after(engine, Seek(drive[0].stamp_ns + 2 * 10**9))
        changed = after(engine, Configure("fusion.omega", 0.9))
        back = after(engine, Configure("fusion.omega", START.start.fusion.omega))
        engine.send(Configure("fusion.omega", 0.9))
        engine.send(Play())
        ended = until(engine, state("ended"))
    entry, shown = changed.log[-1], there.scans - 1
    assert entry.text == f"fusion.omega: {START.start.fusion.omega} → 0.9"
    assert entry.time_ns == there.playback.time_ns == changed.playback.time_ns
    assert (changed.config.fusion.omega, changed.scans) == (0.9, there.scans)
    assert "processed again" in changed.playback.detail
    assert changed.trajectory[:shown].tobytes() == reference[:shown].tobytes()
    assert changed.trajectory[shown].tobytes() != reference[shown].tobytes()
    assert changed.epoch > there.epoch
    assert back.trajectory.tobytes() == there.trajectory.tobytes()
    assert ended.trajectory[: there.scans].tobytes() == changed.trajectory.tobytes()


@pytest.mark.parametrize(
    "rest", [[], [Play(), Pause()], [StepScan(), StepScan()]], ids=["sought", "paused", "stepped"]
)
def test_a_run_with_changes_can_be_repeated_headless(drive: list[Item], rest: list[Command]):
    """The change, planned for the scan at which the run rested, gives the same trajectory without a hand."""
    with running(MemoryRecording(drive), autoplay=False, speed=math.inf) as engine:
        until(engine, state("paused"))
        there = after(engine, Seek(drive[0].stamp_ns + 2 * 10**9), *rest)
        after(engine, Configure("fusion.omega", 0.9))
        engine.send(Play())
        ended = until(engine, state("ended"))
    planned = replace(START, changes=(Change(there.playback.time_ns, "fusion.omega", 0.9),))
    repeated, _ = run_headless(MemoryRecording(drive), planned)
    assert repeated.trajectory.tobytes() == ended.trajectory.tobytes()


def test_a_change_while_it_plays_acts_from_the_next_scan(drive: list[Item]):
    """What is shown stays; the run repeated with the change at its time is the same."""
    with running(MemoryRecording(drive), speed=4.0) as engine:
        until(engine, lambda now: now.scans > 20)
        engine.send(Configure("fusion.omega", 0.9))
        changed = until(engine, lambda now: now.config.fusion.omega == 0.9)
        engine.send(SetSpeed(math.inf))
        ended = until(engine, state("ended"))
    planned = replace(START, changes=(Change(changed.log[-1].time_ns + 1, "fusion.omega", 0.9),))
    repeated, _ = run_headless(MemoryRecording(drive), planned)
    assert repeated.trajectory.tobytes() == ended.trajectory.tobytes()


def test_a_preset_is_one_line_of_the_log_and_can_be_taken_back(drive: list[Item]):
    """All its settings change at once; the default one restores those settings and leaves the others."""
    with running(MemoryRecording(drive), autoplay=False, speed=math.inf) as engine:
        until(engine, state("paused"))
        lines = len(after(engine, Seek(drive[0].stamp_ns + 10**9)).log)
        paper = after(engine, ConfigureAll("preset paper", PRESETS["paper"]))
        again = after(engine, ConfigureAll("preset paper", PRESETS["paper"]))
        default = after(engine, ConfigureAll("preset default", PRESETS["default"]))
    assert paper.config == with_values(START.start, PRESETS["paper"])
    assert [entry.text for entry in paper.log[lines:]] == [
        f"preset paper: {len(PRESETS['paper'])} settings changed"
    ]
    assert again.log == paper.log
    assert default.config == START.start
    assert nearest_preset(default.config)[0] == "default"


def test_one_bad_value_refuses_all_of_them(drive: list[Item]):
    """Settings that change together change all or none."""
    with running(MemoryRecording(drive), autoplay=False) as engine:
        until(engine, state("paused"))
        refused = after(engine, ConfigureAll("some", {"matcher.sigma": 0.5, "fusion.omega": 7.0}))
    assert "fusion.omega is 7" in refused.log[-1].text
    assert refused.config == START.start


def test_a_change_belongs_to_its_time(drive: list[Item]):
    """Going back shows the past with its old value; beyond the change the new one acts again."""
    with running(MemoryRecording(drive), autoplay=False, speed=math.inf) as engine:
        until(engine, state("paused"))
        there = after(engine, Seek(drive[0].stamp_ns + 2 * 10**9))
        changed = after(engine, Configure("fusion.omega", 0.9))
        before = after(engine, Seek(drive[0].stamp_ns + 10**9))
        again = after(engine, Seek(there.playback.time_ns))
    assert before.config.fusion.omega == START.start.fusion.omega
    assert before.trajectory.tobytes() == there.trajectory[: before.scans].tobytes()
    assert again.trajectory.tobytes() == changed.trajectory.tobytes()


def test_a_change_can_act_on_the_whole_run(drive: list[Item]):
    """The recording runs again up to the same instant, with the value from the first scan on."""
    with running(MemoryRecording(drive), autoplay=False, speed=math.inf) as engine:
        until(engine, state("paused"))
        there = after(engine, Seek(drive[0].stamp_ns + 2 * 10**9))
        after(engine, Configure("fusion.omega", 0.5))
        changed = after(engine, Configure("fusion.omega", 0.9, throughout=True))
        engine.send(Play())
        ended = until(engine, state("ended"))
    assert changed.playback.time_ns == there.playback.time_ns
    assert changed.log[-1].text == "fusion.omega: 0.5 → 0.9, for the whole run"
    assert changed.log[-1].time_ns == there.playback.time_ns
    expected, _ = run_headless(MemoryRecording(drive), Settings(with_value(START.start, "fusion.omega", 0.9)))
    assert ended.trajectory.tobytes() == expected.trajectory.tobytes()


def test_a_setting_of_the_map_runs_again_to_the_same_instant(drive: list[Item]):
    """The number of levels changes by a re-run up to here, as if it had been so from the start."""
    with running(MemoryRecording(drive), autoplay=False) as engine:
        until(engine, state("paused"))
        there = after(engine, Seek(drive[0].stamp_ns + 2 * 10**9))
        engine.send(Configure("map.levels", 2))
        again = until(engine, lambda now: now.epoch == 1 and now.playback.state == "paused")
    assert len(again.maps) == 2
    assert again.playback.time_ns == there.playback.time_ns
    assert again.scans == there.scans
    assert (again.log[-1].text, again.log[-1].time_ns) == (
        f"map.levels: {START.start.map.levels} → 2",
        there.playback.time_ns,
    )


@pytest.mark.parametrize(("name", "value"), [("fusion.omega", 7.0), ("no.such", 1), ("matcher.sigma", math.nan)])
def test_a_bad_setting_is_a_line_in_the_log(drive: list[Item], name: str, value: float):
    """Nonsense from a browser changes nothing and stops nothing; who asked is told."""
    with running(MemoryRecording(drive), autoplay=False) as engine:
        until(engine, state("paused"))
        refused = after(engine, Configure(name, value))
        assert (refused.log[-1].level, refused.log[-1].answer) == ("warning", True)
        assert name in refused.log[-1].text
        assert refused.config == START.start
        assert after(engine, Seek(10**20)).playback.state == "ended"


def test_a_map_beyond_the_limit_is_refused_and_the_run_goes_on(drive: list[Item]):
    """It would have failed the run: the map that is there stays."""
    tight = Settings(with_value(START.start, "map.limit", 20.0))
    with running(MemoryRecording(drive), tight, autoplay=False) as engine:
        until(engine, state("paused"))
        refused = after(engine, Configure("map.size", 4096))
        assert "map.limit is 20 MB" in refused.log[-1].text
        assert (refused.epoch, refused.playback.state) == (0, "paused")
        smaller = after(engine, Configure("map.size", 1024))
        assert smaller.config.map.size == 1024
        refused = after(engine, Configure("map.limit", 10.0))
        assert "takes 14 MB, map.limit is 10 MB" in refused.log[-1].text
        assert refused.config.map.limit == 20.0


def test_a_limit_that_was_planned_is_in_the_way_of_no_other_setting(drive: list[Item]):
    """A settings file may stop the map's growth on the way, below the size that the next run would begin with."""
    planned = replace(START, start=with_value(START.start, "map.size", 1024))
    planned = planned.changed(drive[0].stamp_ns, "map.limit", 5.0)
    with running(MemoryRecording(drive), planned, autoplay=False, speed=math.inf) as engine:
        until(engine, state("paused"))
        after(engine, Seek(drive[0].stamp_ns + 10**9))
        assert after(engine, Configure("fusion.omega", 0.9)).config.fusion.omega == 0.9


def test_a_bad_speed_is_refused(drive: list[Item]):
    """Not a number, zero and negative speeds change nothing."""
    with running(MemoryRecording(drive), autoplay=False, speed=2.0) as engine:
        until(engine, state("paused"))
        for speed in (math.nan, 0.0, -1.0):
            refused = after(engine, SetSpeed(speed))
            assert refused.playback.speed == 2.0
            assert refused.log[-1].level == "warning"
