"""What takes a map or values away: a stream asks first, and for a minute everything can be taken back."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from hectorscope.inputs import Item
from hectorscope.run.settings import Settings
from hectorscope.session.commands import (
    Agree,
    Command,
    Configure,
    ConfigureAll,
    Decline,
    Pause,
    Play,
    Restart,
    Save,
    Seek,
    SetSpeed,
    Undo,
)
from hectorscope.session.engine import Engine
from hectorscope.session.snapshot import Question, Snapshot
from slam_core.config import PRESETS, with_value, with_values
from slam_core.measurements import LaserScan
from tests.engines import START, after, running, state, until
from tests.sources import MemoryRecording, MemoryStream

BY_HAND = Settings(with_value(START.start, "fusion.omega", 0.3))
LOSING = {
    "restart": Restart(),
    "another number of levels": Configure("map.levels", 2),
    "a preset over values set by hand": ConfigureAll("preset default", {"fusion.omega": START.start.fusion.omega}),
}


def packets(items: list[Item]) -> Iterator[list[Item]]:
    """The items up to each scan and with it."""
    packet: list[Item] = []
    for item in items:
        packet.append(item)
        if isinstance(item, LaserScan):
            yield packet
            packet = []
    yield packet


IN_FLIGHT = 6  # scans, of the sixteen that a live queue holds; the sequencer keeps some of them


class Robot:
    """A stream that is sent scan by scan, so that none is dropped."""

    def __init__(self, drive: list[Item], engine: Engine, stream: MemoryStream) -> None:
        self._packets = list(packets(drive))
        self._engine, self._stream = engine, stream

    def drive(self, scans: int | None = None) -> Snapshot:
        """So many scans more, or all; the snapshot once the engine has had them."""
        number = len(self._packets) if scans is None else scans
        begin = had(until(self._engine, lambda now: now.obeyed == self._engine.sent and caught_up(now)))
        for sent, packet in enumerate(self._packets[:number], 1):
            self._stream.send(packet)
            seen = until(self._engine, lambda now, due=begin + sent - IN_FLIGHT: had(now) >= due)
        del self._packets[:number]
        return seen


def had(snapshot: Snapshot) -> int:
    """Scans that the run shown has had."""
    return snapshot.scans + sum(snapshot.report.skipped.values())


def caught_up(snapshot: Snapshot) -> bool:
    """Whether nothing of the stream waits behind an undo."""
    return "catching up" not in snapshot.playback.detail


@contextmanager
def robot(drive: list[Item], settings: Settings = START, **options: object) -> Iterator[tuple[Engine, Robot]]:
    """A run on a stream, and the robot that sends it."""
    stream = MemoryStream()
    with running(stream, settings, **options) as engine:  # type: ignore[arg-type]
        yield engine, Robot(drive, engine, stream)


def asked(engine: Engine, command: Command) -> Question:
    """The question that a command leads to."""
    engine.send(command)
    question = until(engine, lambda now: now.obeyed == engine.sent and now.question).question
    assert question is not None
    return question


@pytest.mark.parametrize("command", LOSING.values(), ids=LOSING)
def test_a_stream_asks_before_it_loses_anything(drive: list[Item], command: Command):
    """Whatever a page sends: without a yes to this very question nothing happens, and a no ends it."""
    with robot(drive, BY_HAND) as (engine, sender):
        before = sender.drive(30)
        question = asked(engine, command)
        for answer in (Agree(question.number + 1), Agree(-1), Decline(question.number + 7)):
            engine.send(answer)
        still = until(engine, lambda now: now.obeyed == engine.sent)
        engine.send(Decline(question.number))
        declined = until(engine, lambda now: now.obeyed == engine.sent)
        engine.send(Agree(question.number))
        late = until(engine, lambda now: now.obeyed == engine.sent)
    assert still.question == question
    assert declined.question is late.question is late.undo is None
    assert (late.epoch, late.config) == (before.epoch, before.config)
    assert late.scans >= before.scans > 0


@pytest.mark.parametrize("command", LOSING.values(), ids=LOSING)
def test_what_a_stream_lost_comes_back_as_if_nothing_had_been(
    drive: list[Item], reference_by_hand: np.ndarray, command: Command
):
    """Map, trajectory and record are there again, and what the robot sent meanwhile is worked through."""
    with robot(drive, BY_HAND) as (engine, sender):
        before = sender.drive(30)
        engine.send(Agree(asked(engine, command).number))
        lost = until(engine, lambda now: now.obeyed == engine.sent)
        assert lost.undo is not None
        if not isinstance(command, ConfigureAll):
            assert lost.epoch > before.epoch
            assert lost.scans < before.scans
            sender.drive(12)
        engine.send(Undo())
        sender.drive()
        back = until(engine, lambda now: now.obeyed == engine.sent and now.scans >= len(reference_by_hand) - 1)
    rows = slice(0, len(reference_by_hand) - 1)
    assert back.undo is None
    assert back.config == BY_HAND.start
    assert back.report.dropped == 0
    if not isinstance(command, ConfigureAll):
        assert back.trajectory[rows, 1:].tobytes() == reference_by_hand[rows, 1:].tobytes()
    assert any(entry.text.startswith("Undone: ") for entry in back.log)


def test_nothing_is_asked_where_nothing_is_lost(drive: list[Item]):
    """Without a map there is none to lose, and the log has the old value of a single setting."""
    with robot(drive) as (engine, sender):
        engine.send(Restart())
        fresh = until(engine, lambda now: now.obeyed == engine.sent)
        sender.drive(20)
        engine.send(Configure("fusion.omega", 0.5))
        engine.send(ConfigureAll("preset paper", PRESETS["paper"]))  # none of these was set by hand
        engine.send(Configure("fusion.omega", 7.0))
        now = until(engine, lambda now: now.obeyed == engine.sent)
    assert fresh.question is fresh.undo is now.question is now.undo is None
    assert now.config == with_values(START.start, {**PRESETS["paper"], "fusion.omega": 0.5})


def test_a_restart_of_a_recording_can_be_taken_back(drive: list[Item], reference: np.ndarray):
    """It asks nothing, as a replay brings all back; undone, the same run goes on to the same end."""
    with running(MemoryRecording(drive), autoplay=False, speed=math.inf) as engine:
        until(engine, state("paused"))
        there = after(engine, Seek(drive[0].stamp_ns + 2 * 10**9))
        empty = after(engine, Restart())
        assert (empty.scans, empty.question) == (0, None)
        assert empty.undo is not None and "restart" in empty.undo.what
        back = after(engine, Undo())
        assert back.trajectory.tobytes() == there.trajectory.tobytes()
        assert back.series.tobytes() == there.series.tobytes()
        assert back.map_updates == there.map_updates
        assert (back.playback, back.undo) == (there.playback, None)
        engine.send(Play())
        ended = until(engine, state("ended"))
    assert ended.trajectory.tobytes() == reference.tobytes()
    assert ended.report.read["LaserScan"] == sum(isinstance(item, LaserScan) for item in drive)


def test_a_run_that_had_ended_has_ended_again(drive: list[Item], reference: np.ndarray):
    """Play at the end begins again; taken back, the end is there with its map."""
    with running(MemoryRecording(drive), speed=math.inf) as engine:
        until(engine, state("ended"))
        engine.send(SetSpeed(0.1))
        engine.send(Play())
        until(engine, lambda now: now.epoch == 1 and now.playback.state == "playing")
        engine.send(Undo())
        back = until(engine, lambda now: now.epoch == 2)
    assert back.playback.state == "ended"
    assert back.trajectory.tobytes() == reference.tobytes()


def test_a_change_of_the_whole_run_can_be_taken_back(drive: list[Item]):
    """With the changes that it replaced, and at rest the scan is shown as it was."""
    with running(MemoryRecording(drive), autoplay=False, speed=math.inf) as engine:
        until(engine, state("paused"))
        after(engine, Seek(drive[0].stamp_ns + 2 * 10**9))
        there = after(engine, Configure("fusion.omega", 0.5))
        after(engine, Configure("fusion.omega", 0.9, throughout=True))
        back = after(engine, Undo())
        after(engine, ConfigureAll("all", {"fusion.omega": 0.1, "matcher.sigma": 0.02, "tracking.lost_after": 9}))
        values = after(engine, Undo())
        nothing = after(engine, Undo())
    assert back.config == values.config == there.config
    assert back.trajectory.tobytes() == values.trajectory.tobytes() == there.trajectory.tobytes()
    assert values.log[-1].text == "Undone: all. 3 settings are as before"
    assert "nothing to undo" in nothing.log[-1].text


def test_a_held_key_does_not_fill_the_memory(drive: list[Item]):
    """Of many restarts in a row only few runs are kept, the longest among them."""
    with running(MemoryRecording(drive), autoplay=False, speed=math.inf) as engine:
        until(engine, state("paused"))
        longest = after(engine, Seek(drive[0].stamp_ns + 3 * 10**9))
        after(engine, Restart(), Restart(), Restart())  # empty ones are not worth it
        for _ in range(6):
            after(engine, Seek(drive[0].stamp_ns + 10**9))
            after(engine, Restart())
        counts = [after(engine, Undo()).scans for _ in range(4)]
        assert after(engine, Undo()).undo is None
    assert counts[-1] == longest.scans
    assert all(0 < count < longest.scans for count in counts[:-1])


def test_a_paused_stream_stays_paused_by_an_undo(drive: list[Item]):
    """Who paused it wants it to rest: only the map comes back."""
    with robot(drive) as (engine, sender):
        before = sender.drive(30)
        engine.send(Agree(asked(engine, Restart()).number))
        engine.send(Pause())
        engine.send(Undo())
        back = until(engine, lambda now: now.obeyed == engine.sent)
    assert back.scans >= before.scans
    assert back.playback.state == "paused"


def test_each_run_is_saved_to_a_place_of_its_own(drive: list[Item], tmp_path: Path):
    """What was saved before a restart is not overwritten after it; a run taken back has its own place again."""
    with running(MemoryRecording(drive), speed=math.inf, out=tmp_path) as engine:  # type: ignore[arg-type]
        until(engine, state("ended"))
        saved(engine)
        first = (tmp_path / "trajectory.tum").read_bytes()
        after(engine, Restart(), Pause(), Seek(drive[0].stamp_ns + 10**9))
        assert str(tmp_path / "run-2") in saved(engine)
        assert (tmp_path / "trajectory.tum").read_bytes() == first
        after(engine, Undo())
        assert saved(engine).endswith(str(tmp_path))
    assert (tmp_path / "trajectory.tum").read_bytes() == first
    assert len((tmp_path / "run-2" / "trajectory.tum").read_bytes()) < len(first)


def saved(engine: Engine) -> str:
    """The sentence that answers a Save."""
    lines = len(after(engine).log)
    engine.send(Save())
    return until(engine, lambda now: len(now.log) > lines).log[-1].text


@pytest.fixture(scope="module")
def reference_by_hand(drive: list[Item]) -> np.ndarray:
    """The trajectory of the drive with the settings by hand, without a page."""
    from hectorscope.run.headless import run_headless  # noqa: PLC0415

    return run_headless(MemoryRecording(drive), BY_HAND)[0].trajectory
