"""After a crash the next start goes on with the run before it."""

import json
import random
import re
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from hectorscope.run.headless import run_headless
from hectorscope.run.settings import Settings
from hectorscope.session import journal_files
from hectorscope.session.checkpoint_file import read_checkpoint
from hectorscope.session.commands import Agree, Configure, Decline, Pause
from hectorscope.session.journal import Journal, resumed
from hectorscope.session.journal_files import CLOSED, STAMP, begun
from hectorscope.session.mailbox import Mailbox
from hectorscope.session.snapshot import Snapshot
from hectorscope.session.station import Station
from hectorscope.session.station_commands import SetPose
from hectorscope.session.transport import PAUSED
from tests.cases import quick_first
from tests.engines import running, until
from tests.live.conftest import Replay
from tests.live.journals import (
    LOST_S,
    LOST_SCANS,
    SEED,
    abandon,
    compare,
    is_paused,
    kept,
    killed,
    left,
    reopen,
)
from tests.live.measurements import GIVE_UP_S, TOPICS, opened, poses
from tests.sources import MemoryStream


@pytest.mark.parametrize("number", quick_first(range(2)))
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
    with kept(replay(drive, *TOPICS, "--speed", "3").uri, tmp_path) as (engine, journal):
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


def test_the_question_names_the_run_by_the_clock_on_the_wall(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the day where that is another one, and says what either answer does."""
    with monkeypatch.context() as patch:
        patch.setenv("TZ", "EAST-9")
        time.tzset()
        left(tmp_path, "20200101T160000Z-1")
        with running(MemoryStream(), station=Station(journal=Journal(tmp_path, "a", reopen))) as engine:
            asked = until(engine, lambda now: now.question is not None).question
        today = begun(Path(time.strftime(STAMP, time.gmtime())))
    time.tzset()
    assert asked is not None
    assert asked.text.startswith("The run of 02 Jan 01:00 ended without being closed.")
    assert (asked.agree, asked.decline) == ("Go on with the map of 02 Jan 01:00", "Begin a new map")
    assert re.fullmatch(r"\d\d:\d\d", today)


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
    with kept(replay(drive, *TOPICS, "--speed", "2").uri, tmp_path) as (engine, journal):
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
