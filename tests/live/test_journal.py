"""The journal of a live run: after a crash the next start goes on with it."""

import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from hectorscope.inputs import Source, SourceOptions
from hectorscope.run.headless import run_headless
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.session import journal_files
from hectorscope.session.commands import Agree, Configure
from hectorscope.session.journal import Journal, resumed
from hectorscope.session.journal_files import CHECKPOINT, JournalError, read_checkpoint
from hectorscope.session.station import Station
from hectorscope.sources import open_source
from tests.engines import running, until
from tests.live.conftest import Replay
from tests.live.measurements import GIVE_UP_S, TOPICS, opened
from tests.live.test_replay import poses

RUN = """
import sys
from pathlib import Path
from tests.live.test_journal import run_for_ever
run_for_ever(sys.argv[1], Path(sys.argv[2]))
"""
SEED = 7
LOST_S = 10.0


def reopen(folder: Path) -> Source:
    """The messages of an earlier run."""
    return open_source(str(folder), SourceOptions())


def run_for_ever(uri: str, root: Path) -> None:
    """A live run with a journal, to be killed; tells each scan, and leaves checkpoints often."""
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
    last_ns = 0
    for line in process.stdout:
        count, last_ns = map(int, line.split())
        if count >= scans:
            break
    process.send_signal(signal.SIGKILL)
    process.wait()
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
    """Whenever it was killed: the poses are those of the run, and of the last ten seconds at most are missing."""
    scans = random.Random(SEED + number).randint(15, 50)
    folder, last_ns = killed(replay(drive, *TOPICS, "--speed", "1").uri, tmp_path, scans)
    again, _, _ = resumed(folder, reopen, Settings(), None)
    with opened(drive) as source:
        whole, _ = run_headless(source, Settings())
    assert again.time_ns >= last_ns - LOST_S * 1e9
    assert again.scans > 0
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
    again, scans, _ = resumed(journal.folder, reopen, Settings(), None)
    assert scans == again.scans - saved.checkpoint.scans
    rows = min(live.scans, again.scans)
    assert rows >= 45
    assert poses(again.start_ns or 0, again.trajectory[:rows]) == poses(
        live.playback.start_ns, live.trajectory[:rows]
    )
    assert again.settings.at(again.time_ns).map.update_distance == 0.3


def test_the_next_start_offers_to_go_on(drive: Path, tmp_path: Path, replay: Callable[..., Replay]) -> None:
    """The page asks; who agrees has the map of before, and the run goes on with it; it is not offered again."""
    server = replay(drive, *TOPICS, "--end", "3")
    folder, _ = killed(server.uri, tmp_path, 20)
    server.kill()
    before, _, _ = resumed(folder, reopen, Settings(), None)
    replay(drive, *TOPICS, "--port", str(server.port), "--begin", "3")
    with (
        opened(server.uri) as source,
        running(source, Settings(), station=Station(journal=Journal(tmp_path, server.uri, reopen))) as engine,
    ):
        asked = until(engine, lambda now: now.question is not None)
        assert asked.question is not None
        assert "ended without being closed" in asked.question.text
        engine.send(Agree(asked.question.number))
        now = until(engine, lambda now: now.scans >= before.scans + 5, GIVE_UP_S)
    assert np.array_equal(now.trajectory[: before.scans], before.trajectory)
    assert now.map_updates >= before.slam.map.updates
    assert Journal(tmp_path, server.uri, reopen).past is None


def test_a_run_that_ended_in_order_is_not_offered(tmp_path: Path) -> None:
    """Nor one that another program is still writing, nor that of another robot."""
    Journal(tmp_path, "a", reopen).close()
    open_now = Journal(tmp_path, "a", reopen)
    others = [Journal(tmp_path, address, reopen) for address in ("a", "b")]
    assert [journal.past for journal in (open_now, *others)] == [None, None, None]


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
    again, scans, _ = resumed(journal.folder, reopen, Settings(), None)
    assert again.scans == scans >= 25


def test_actions_are_logged_with_what_they_changed(
    drive: Path, tmp_path: Path, replay: Callable[..., Replay]
) -> None:
    """Time, role, action, the settings before and after; one line each, in the order of the actions."""
    import json  # noqa: PLC0415

    journal = Journal(tmp_path, "a", reopen)
    with (
        opened(replay(drive, *TOPICS, "--speed", "3").uri) as source,
        running(source, Settings(), station=Station(journal=journal)) as engine,
    ):
        until(engine, lambda now: now.scans >= 5, GIVE_UP_S)
        engine.send(Configure("map.update_distance", 0.3))
        engine.send(Configure("map.update_distance", 0.5))
        until(engine, lambda now: now.obeyed == 2)
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
