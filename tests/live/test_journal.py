"""The journal of a live run: its checkpoints, its record of actions, and the room it takes."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from hectorscope.run.headless import run_headless
from hectorscope.run.settings import Settings
from hectorscope.session import checkpoint_file, journal_files
from hectorscope.session.active_run import ActiveRun
from hectorscope.session.checkpoint_file import read_checkpoint, write_checkpoint
from hectorscope.session.commands import Configure, Seek
from hectorscope.session.engine import Engine
from hectorscope.session.journal import Journal, resumed
from hectorscope.session.journal_files import CHECKPOINT, JournalError
from hectorscope.session.row_files import RowFiles
from hectorscope.session.station import Station
from hectorscope.session.station_commands import PutMark
from slam_core.measurements import Imu, LaserScan
from tests.engines import until
from tests.live.conftest import Replay
from tests.live.journals import (
    kept,
    left,
    reopen,
)
from tests.live.measurements import GIVE_UP_S, TOPICS, opened, recorded, wait_for
from tests.sources import MemoryStream


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


def test_a_checkpoint_waits_for_the_one_that_is_written(drive: Path, tmp_path: Path) -> None:
    """What was wanted meanwhile is kept by the next one, however soon it comes."""
    with opened(drive) as source:
        pipeline, _ = run_headless(source, Settings())
    run = ActiveRun(Settings(), None, None, live=True)
    run.pipeline = pipeline
    journal = Journal(tmp_path, "a", reopen)
    run.last = Imu(1, np.zeros(3), np.zeros(3))
    journal.keep(run)
    run.annotations = run.annotations.put("note", 1, (0.0, 0.0), (0.0, 0.0, 0.0), "here")
    journal.wanted = True
    journal.keep(run)
    assert journal.wanted

    def kept() -> bool:
        journal.keep(run)
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
        run.admit(next(items))
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
    write_checkpoint(folder, "no checkpoint", RowFiles(folder))  # type: ignore[arg-type]
    found = resumed(folder, reopen, Settings(), None)
    assert found.pipeline.scans > 40
    assert "holds no checkpoint" in found.left_out
    monkeypatch.setattr(checkpoint_file, "our_version", lambda: "another")
    assert "is of another version of the program" in resumed(folder, reopen, Settings(), None).left_out


def test_a_damaged_checkpoint_is_not_read(drive: Path, tmp_path: Path, replay: Callable[..., Replay]) -> None:
    """The run is made again from its messages alone; a checkpoint that others could write is refused as well."""
    with kept(replay(drive, *TOPICS, "--speed", "3").uri, tmp_path) as (engine, journal):
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
    with kept(replay(drive, *TOPICS, "--speed", "3").uri, tmp_path) as (engine, journal):
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
