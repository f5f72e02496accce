"""The journal of a live run: after a crash the next start goes on with it."""

import json
import random
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from hectorscope.inputs import Source, SourceOptions
from hectorscope.run.headless import run_headless
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.run.warmup import load_everything
from hectorscope.session import checkpoint_file, journal_files
from hectorscope.session.active_run import ActiveRun
from hectorscope.session.checkpoint_file import read_checkpoint, write_checkpoint
from hectorscope.session.commands import Agree, Configure, Decline, Pause, Seek
from hectorscope.session.engine import Engine
from hectorscope.session.journal import Journal, resumed
from hectorscope.session.journal_files import CHECKPOINT, CLOSED, JournalError
from hectorscope.session.mailbox import Mailbox
from hectorscope.session.snapshot import Snapshot
from hectorscope.session.station import Station
from hectorscope.session.station_commands import PutMark, SetPose
from hectorscope.session.transport import PAUSED
from hectorscope.sources import open_source
from slam_core.measurements import Imu, LaserScan
from tests.engines import running, until
from tests.live.conftest import Replay
from tests.live.measurements import GIVE_UP_S, TOPICS, opened, recorded
from tests.live.test_replay import poses, wait_for
from tests.sources import MemoryStream

RUN = """
import sys
from pathlib import Path
from tests.live.test_journal import run_for_ever
run_for_ever(sys.argv[1], Path(sys.argv[2]))
"""
SEED = 7
LOST_S = 2.0
LOST_SCANS = 20  # of 10 a second


def reopen(folder: Path) -> Source:
    """The messages of an earlier run."""
    return open_source(str(folder), SourceOptions())


def run_for_ever(uri: str, root: Path) -> None:
    """A live run with a journal, to be killed; tells each scan, and leaves checkpoints often.

    A run that compiles its kernels while the robot speaks drops scans; they are loaded first.
    """
    load_everything()
    with (
        opened(uri) as source,
        running(source, Settings(), station=Station(journal=Journal(root, uri, reopen))) as engine,
    ):
        told = 0
        while True:
            now = engine.mailbox.latest
            if now is not None and now.scans > told:
                told = now.scans
                print(told, now.playback.time_ns, flush=True)
            time.sleep(0.005)


def killed(uri: str, root: Path, scans: int) -> tuple[Path, int]:
    """The journal of a run that was killed behind so many scans, and the time of its last one."""
    command = [sys.executable, "-c", RUN, uri, str(root)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    watch = threading.Timer(3 * GIVE_UP_S, process.kill)  # where kernels are compiled first
    watch.start()
    count, last_ns = 0, 0
    for line in process.stdout:
        count, last_ns = map(int, line.split())
        if count >= scans:
            break
    watch.cancel()
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert count >= scans, "the run got fewer scans than it should"
    (folder,) = journal_files.journals(root)
    return folder, last_ns


def compare(again: Pipeline, whole: Pipeline) -> None:
    """Both have the same poses as far as the first goes."""
    rows = again.scans
    assert poses(again.start_ns or 0, again.trajectory) == poses(whole.start_ns or 0, whole.trajectory[:rows])


@pytest.mark.parametrize("number", range(2))
def test_after_a_kill_the_run_is_there_again(
    drive: Path, replay: Callable[..., Replay], tmp_path: Path, number: int
) -> None:
    """Whenever it was killed: the poses are those of the run, and of the last two seconds at most are missing."""
    scans = random.Random(SEED + number).randint(15, 40)
    folder, last_ns = killed(replay(drive, *TOPICS, "--speed", "1").uri, tmp_path, scans)
    again, *_ = resumed(folder, reopen, Settings(), None)
    with opened(drive) as source:
        whole, _ = run_headless(source, Settings())
    assert again.time_ns >= last_ns - LOST_S * 1e9
    assert again.scans >= scans - LOST_SCANS
    compare(again, whole)


def test_a_checkpoint_with_what_came_then_is_the_run(
    drive: Path, tmp_path: Path, replay: Callable[..., Replay]
) -> None:
    """A checkpoint in the middle and the messages behind it give the poses of the run, to the last bit."""
    journal = Journal(tmp_path, "a", reopen)
    with (
        opened(replay(drive, *TOPICS, "--speed", "3").uri) as source,
        running(source, Settings(), station=Station(journal=journal)) as engine,
    ):
        until(engine, lambda now: now.scans >= 20, GIVE_UP_S)
        engine.send(Configure("map.update_distance", 0.3))
        live = until(engine, lambda now: now.scans >= 50, GIVE_UP_S)
    saved = read_checkpoint(journal.folder)
    assert saved is not None
    assert 20 <= saved.checkpoint.scans < 45
    again, scans, *_ = resumed(journal.folder, reopen, Settings(), None)
    assert scans == again.scans - saved.checkpoint.scans
    rows = min(live.scans, again.scans)
    assert rows >= 45
    assert poses(again.start_ns or 0, again.trajectory[:rows]) == poses(
        live.playback.start_ns, live.trajectory[:rows]
    )
    assert again.settings.at(again.time_ns).map.update_distance == 0.3


def test_the_next_start_offers_to_go_on(
    drive: Path, tmp_path: Path, replay: Callable[..., Replay], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The page asks; who agrees has the map of before, and the run goes on with it; it is not offered again.

    While it is processed again the page says so.
    """
    shown: list[Snapshot] = []
    put = Mailbox.put

    def note(box: Mailbox[Snapshot], now: Snapshot) -> None:
        shown.append(now)
        put(box, now)

    monkeypatch.setattr(Mailbox, "put", note)
    server = replay(drive, *TOPICS, "--end", "3")
    folder, _ = killed(server.uri, tmp_path, 20)
    server.kill()
    before, *_ = resumed(folder, reopen, Settings(), None)
    replay(drive, *TOPICS, "--port", str(server.port), "--begin", "3")
    with (
        opened(server.uri) as source,
        running(source, Settings(), station=Station(journal=Journal(tmp_path, server.uri, reopen))) as engine,
    ):
        asked = until(engine, lambda now: now.question is not None)
        assert asked.question is not None
        assert "ended without being closed" in asked.question.text
        assert asked.station.past
        engine.send(Agree(asked.question.number))
        now = until(engine, lambda now: now.scans >= before.scans + 5, GIVE_UP_S)
        until(engine, lambda _: (folder / CLOSED).exists(), GIVE_UP_S)  # once a checkpoint of the run is there
    assert any("Processing the run before again" in each.playback.detail for each in shown)
    assert not now.station.past
    assert np.array_equal(now.trajectory[: before.scans], before.trajectory)
    assert now.map_updates >= before.slam.map.updates
    assert Journal(tmp_path, server.uri, reopen).past is None


def test_a_run_that_ended_in_order_is_not_offered(tmp_path: Path) -> None:
    """Nor one that another program is still writing, nor that of another robot."""
    Journal(tmp_path, "a", reopen).close()
    open_now = Journal(tmp_path, "a", reopen)
    others = [Journal(tmp_path, address, reopen) for address in ("a", "b")]
    assert [journal.past for journal in (open_now, *others)] == [None, None, None]


def left(root: Path, name: str, address: str = "a", size: int = 1) -> Path:
    """What a run leaves that was killed, with so many bytes of a stream."""
    folder = journal_files.begin(root, address)
    (folder / "stream_0001.mcap").write_bytes(bytes(size))
    return folder.rename(root / name)


def abandon(journal: Journal) -> None:
    """As the end of a process does it: its locks go."""
    for hold in (journal._hold, journal._held, *(journal._replaced or ())[1:]):
        if hold is not None:
            hold.release()


def test_a_run_is_offered_until_somebody_answers(tmp_path: Path) -> None:
    """However often the program is started and killed meanwhile, before anything has come of the stream."""
    first = left(tmp_path, "20200101T000000Z-1")
    for _ in range(journal_files.KEPT + 2):
        journal = Journal(tmp_path, "a", reopen)
        assert journal.past == first
        abandon(journal)
    journal = Journal(tmp_path, "a", reopen)
    journal.forget_past()
    abandon(journal)  # before a checkpoint of the run that went on with it was written
    again = Journal(tmp_path, "a", reopen)
    assert again.past == first
    again.give_up_past()
    again.close()
    assert Journal(tmp_path, "a", reopen).past is None


def test_who_declines_is_not_asked_again(tmp_path: Path) -> None:
    """The next start does not offer the run; this one can still go on with it."""
    past = left(tmp_path, "20200101T000000Z-1")
    with running(MemoryStream(), station=Station(journal=Journal(tmp_path, "a", reopen))) as engine:
        asked = until(engine, lambda now: now.question is not None)
        assert asked.question is not None
        engine.send(Decline(asked.question.number))
        now = until(engine, lambda now: now.obeyed == 1)
    assert now.station.past
    assert (past / CLOSED).exists()


def test_the_oldest_journals_give_way_to_their_size(tmp_path: Path) -> None:
    """Neither those to be offered do, whatever their address, nor the present one."""
    other = left(tmp_path, "20191231T000000Z-1", "c", size=3000)
    offered = left(tmp_path, "20200101T000000Z-1", size=3000)
    closed = [left(tmp_path, f"2020010{number}T000000Z-1", "b", size=3000) for number in (2, 3)]
    for folder in closed:
        journal_files.mark_closed(folder)
    journal = Journal(tmp_path, "a", reopen, kept_bytes=10_000)
    assert journal_files.journals(tmp_path) == [other, offered, closed[1], journal.folder]
    journal.close()


def test_a_run_without_a_scan_is_passed_over(drive: Path, tmp_path: Path) -> None:
    """Who goes on has the map of the run before it, and is told why."""
    whole = left(tmp_path, "20200101T000000Z-1")
    (whole / "stream_0001.mcap").write_bytes(drive.read_bytes())
    left(tmp_path, "20200102T000000Z-1")
    journal = Journal(tmp_path, "a", reopen)
    words: list[str] = []
    found = journal.resumed(Settings(), None, words.append)
    assert found.pipeline.scans > 40
    assert "20200102T000000Z-1 holds nothing that could be gone on with" in found.left_out
    assert journal.past == whole
    journal.close()


def test_a_pose_set_by_hand_and_a_pause_are_there_again(
    drive: Path, tmp_path: Path, replay: Callable[..., Replay]
) -> None:
    """The pose is that of the hand, its action has both, and scans of the pause are let go by again."""
    journal = Journal(tmp_path, "a", reopen)
    with (
        opened(replay(drive, *TOPICS, "--speed", "2").uri) as source,
        running(source, Settings(), station=Station(journal=journal)) as engine,
    ):
        until(engine, lambda now: now.scans >= 15, GIVE_UP_S)
        engine.send(Configure("tracking.relocalise", value=False))
        engine.send(SetPose(40.0, 0.0, 0.0))
        engine.send(Pause())
        paused = until(engine, lambda now: now.obeyed == 3 and now.report.skipped.get(PAUSED, 0) > 15, GIVE_UP_S)
        until(engine, lambda _: is_paused(journal.folder), GIVE_UP_S)
    again = resumed(journal.folder, reopen, Settings(), None).pipeline
    assert again.slam.now_ns is not None
    assert again.slam.motion_at([again.slam.now_ns])[0, 0] > 20.0
    assert abs(again.scans - paused.scans) <= 5
    assert again.skipped[PAUSED] > 5
    actions = [json.loads(line) for line in (journal.folder / "actions.jsonl").read_text().splitlines()]
    before, after = actions[1]["changed"]["pose"]
    assert before[0] < 20.0 < after[0]


def is_paused(folder: Path) -> bool:
    """Whether the newest checkpoint is of a run that lets scans go by."""
    saved = read_checkpoint(folder)
    return saved is not None and saved.paused


def test_a_checkpoint_waits_for_the_one_that_is_written(drive: Path, tmp_path: Path) -> None:
    """What was wanted meanwhile is kept by the next one, however soon it comes."""
    with opened(drive) as source:
        pipeline, _ = run_headless(source, Settings())
    run = ActiveRun(Settings(), None, None, live=True)
    run.pipeline = pipeline
    journal = Journal(tmp_path, "a", reopen)
    item = Imu(1, np.zeros(3), np.zeros(3))
    journal.keep(run, item)
    run.annotations = run.annotations.put("note", 1, (0.0, 0.0), (0.0, 0.0, 0.0), "here")
    journal.wanted = True
    journal.keep(run, item)
    assert journal.wanted

    def kept() -> bool:
        journal.keep(run, item)
        return not journal.wanted

    wait_for(kept)
    journal.close()
    saved = read_checkpoint(journal.folder)
    assert saved is not None
    assert [mark.text for mark in saved.annotations.marks] == ["here"]


def test_an_action_leaves_no_checkpoint_between_a_scan_and_its_step(drive: Path, tmp_path: Path) -> None:
    """Or that scan would be missing in it: it is left once the run has had all that came."""
    items = iter(recorded(drive))
    journal = Journal(tmp_path, "a", reopen)
    engine, station = Engine(MemoryStream(), Settings()), Station(journal=journal)
    engine.attach(station)
    station.begin(engine._control)
    run = engine._session.run
    while run.pipeline.scans < 3 or not isinstance(run.waiting, LaserScan):
        if run.waiting is not None:
            run.step()
            continue
        item = next(items)
        run.admit(item)
        station.admitted(item)
    station.logged(engine._control.obey, PutMark("note", 1.0, 2.0))
    station.keep()
    waits = journal.wanted, journal._writer.busy
    run.step()
    station.keep()
    journal.close()
    assert waits == (True, False)
    assert not journal.wanted
    saved = read_checkpoint(journal.folder)
    assert saved is not None
    assert len(saved.annotations.marks) == 1


def test_an_odd_checkpoint_is_left_out_with_the_reason(
    drive: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One of another version, and one that holds something else; the run is made again from its messages."""
    folder = left(tmp_path, "20200101T000000Z-1")
    (folder / "stream_0001.mcap").write_bytes(drive.read_bytes())
    write_checkpoint(folder, "no checkpoint")  # type: ignore[arg-type]
    found = resumed(folder, reopen, Settings(), None)
    assert found.pipeline.scans > 40
    assert "holds no checkpoint" in found.left_out
    monkeypatch.setattr(checkpoint_file, "our_version", lambda: "another")
    assert "is of another version of the program" in resumed(folder, reopen, Settings(), None).left_out


def test_a_damaged_checkpoint_is_not_read(drive: Path, tmp_path: Path, replay: Callable[..., Replay]) -> None:
    """The run is made again from its messages alone; a checkpoint that others could write is refused as well."""
    journal = Journal(tmp_path, "a", reopen)
    with (
        opened(replay(drive, *TOPICS, "--speed", "3").uri) as source,
        running(source, Settings(), station=Station(journal=journal)) as engine,
    ):
        until(engine, lambda now: now.scans >= 30, GIVE_UP_S)
    path = journal.folder / CHECKPOINT
    content = bytearray(path.read_bytes())
    path.chmod(0o666)
    with pytest.raises(JournalError, match="written by others"):
        read_checkpoint(journal.folder)
    path.chmod(0o600)
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    with pytest.raises(JournalError, match="is damaged"):
        read_checkpoint(journal.folder)
    again, scans, *_ = resumed(journal.folder, reopen, Settings(), None)
    assert again.scans == scans >= 25


def test_actions_are_logged_with_what_they_changed(
    drive: Path, tmp_path: Path, replay: Callable[..., Replay]
) -> None:
    """Time, role, action, the settings before and after; one line each, in the order of the actions."""
    journal = Journal(tmp_path, "a", reopen)
    with (
        opened(replay(drive, *TOPICS, "--speed", "3").uri) as source,
        running(source, Settings(), station=Station(journal=journal)) as engine,
    ):
        until(engine, lambda now: now.scans >= 5, GIVE_UP_S)
        engine.send(Configure("map.update_distance", 0.3))
        engine.send(Configure("map.update_distance", 0.5))
        engine.send(Seek(0))  # a look
        until(engine, lambda now: now.obeyed == 3)
    lines = [json.loads(line) for line in (journal.folder / "actions.jsonl").read_text().splitlines()]
    assert [line["action"] for line in lines] == ["Configure", "Configure"]
    assert [line["changed"]["map.update_distance"] for line in lines] == [[0.4, 0.3], [0.3, 0.5]]
    assert all(line["role"] == "operator" and line["time"] > 0 for line in lines)


def test_a_journal_that_cannot_be_written_is_refused(tmp_path: Path) -> None:
    """With the reason and the remedy."""
    (tmp_path / "file").touch()
    with pytest.raises(JournalError, match=r"cannot be kept in .*: give another --journal, or off"):
        Journal(tmp_path / "file", "a", reopen)


def test_old_journals_are_removed(tmp_path: Path) -> None:
    """The newest ones stay."""
    for number in range(8):
        journal = Journal(tmp_path, str(number), reopen)
        journal.close()
        journal.folder.rename(tmp_path / f"2020010{number}T000000Z-1")
    Journal(tmp_path, "last", reopen).close()
    assert len(journal_files.journals(tmp_path)) == journal_files.KEPT
