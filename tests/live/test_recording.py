"""A stream that is recorded while it is shown, against the real server."""

import resource
import signal
import subprocess
import sys
from collections.abc import Callable
from itertools import count, islice
from pathlib import Path
from random import Random

import pytest

from hectorscope.inputs import Message, Tappable
from hectorscope.ros import stream_recorder
from hectorscope.ros.stream_recorder import RecordError, StreamRecorder, parts
from hectorscope.run.headless import run_headless
from hectorscope.run.settings import Settings
from hectorscope.session.station import Station
from hectorscope.session.station_commands import Record
from tests.engines import running, until
from tests.live.conftest import Replay
from tests.live.measurements import GIVE_UP_S, TOPICS, opened, plain, poses, recorded, wait_for

FIRST = 200  # messages that meet the full disk
FULL = f"""
import resource, signal, sys
from pathlib import Path
from hectorscope.inputs import Message
from hectorscope.ros.stream_recorder import StreamRecorder
from tests.live.test_recording import sent, wait_for
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
recorder = StreamRecorder(Path(sys.argv[1]), again_s=0.2)
def take(numbers):
    for number in numbers:
        recorder.take(Message("/a", "cdr", "a/msg/A", "", "msg", number, sent(number)))
_, most = resource.getrlimit(resource.RLIMIT_FSIZE)
resource.setrlimit(resource.RLIMIT_FSIZE, (50000, most))
take(range({FIRST}))
wait_for(lambda: recorder.failed)
print(recorder.warning)
resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))
take(range({FIRST}, {FIRST} + 20))
wait_for(lambda: not recorder.failed)
print(recorder.warning or "no warning")
recorder.close()
"""


def message(number: int, received_ns: int | None = None, size: int = 100) -> Message:
    """One of a type of which nothing is decoded here."""
    at_ns = number if received_ns is None else received_ns
    return Message("/chatter", "cdr", "std_msgs/msg/String", "string data", "msg", at_ns, bytes([number]) * size)


@pytest.mark.parametrize("drive", ["ros1.bag", "ros2.mcap"], indirect=True)
def test_a_recording_of_a_stream_gives_its_measurements(
    drive: Path, replay: Callable[..., Replay], tmp_path: Path
) -> None:
    """What was heard is read back bit by bit and in the same order, over several files, without a warning."""
    expected = recorded(drive)
    recorder = StreamRecorder(tmp_path, part_bytes=100_000)
    with opened(replay(drive, *TOPICS, "--speed", "6").uri) as source:
        assert isinstance(source, Tappable)
        source.tap(recorder)
        received = list(islice(source.items(), len(expected)))
    recorder.close()
    assert len(parts(tmp_path)) > 1
    with opened(tmp_path) as source:
        assert [plain(item) for item in source.items()] == [plain(item) for item in received]
        assert not any("damaged" in note for note in source.report.notes)
        assert not source.report.warnings


def test_a_recorded_mission_is_replayed_to_the_same_poses(
    drive: Path, replay: Callable[..., Replay], tmp_path: Path
) -> None:
    """The trajectory of the recording of a live run is that of the live run, to the last bit."""
    with (
        opened(replay(drive, *TOPICS, "--speed", "2").uri) as source,
        running(source, Settings(), station=Station(tmp_path)) as engine,
    ):
        live = until(engine, lambda now: now.scans >= 55, GIVE_UP_S)
        assert live.station.records is True
    assert live.report.dropped == 0
    with opened(tmp_path) as source:
        pipeline, _ = run_headless(source, Settings())
    again = poses(pipeline.start_ns or 0, pipeline.trajectory[: live.scans])
    assert again == poses(live.playback.start_ns, live.trajectory)


def test_the_page_switches_the_recording_off_and_on(
    drive: Path, replay: Callable[..., Replay], tmp_path: Path
) -> None:
    """Each time it begins another file, in which the static transforms come first."""
    with (
        opened(replay(drive, *TOPICS, "--speed", "2").uri) as source,
        running(source, Settings(), station=Station(tmp_path)) as engine,
    ):
        until(engine, lambda now: now.scans >= 5, GIVE_UP_S)
        engine.send(Record(on=False))
        until(engine, lambda now: now.station.records is False)
        engine.send(Record(on=True))
        on = until(engine, lambda now: now.station.records is True)
        until(engine, lambda now: now.scans >= on.scans + 5, GIVE_UP_S)
    first, second = parts(tmp_path)
    for part in (first, second):
        with opened(part) as source:
            assert sum(1 for _ in source.items()) > 5
            assert source.report.read["/tf_static"] >= 1


def test_without_a_folder_the_switch_is_refused(drive: Path, replay: Callable[..., Replay]) -> None:
    """The page says how to get one."""
    with opened(replay(drive, *TOPICS).uri) as source, running(source, Settings()) as engine:
        engine.send(Record(on=True))
        now = until(engine, lambda now: now.log and now.log[-1].answer)
    assert "start the program with --record DIR" in now.log[-1].text
    assert now.station.records is None


@pytest.mark.parametrize("limit", [{"part_bytes": 0}, {"part_s": 0.5}])
def test_files_are_rotated_by_size_and_by_time(tmp_path: Path, limit: dict[str, float]) -> None:
    """A file that is long or large enough is closed, and another one begun; empty ones do not stay."""
    ticks = count()
    recorder = StreamRecorder(tmp_path, clock=lambda: float(next(ticks)), **limit)  # type: ignore[arg-type]
    for number in range(3):
        recorder.take(message(number))
    recorder.close()
    assert len(parts(tmp_path)) == 3


def test_a_clock_that_goes_back_does_not_change_the_order(tmp_path: Path) -> None:
    """Messages are recorded in the order of arrival; the time of the other side is kept beside."""
    from mcap.reader import make_reader  # noqa: PLC0415

    recorder = StreamRecorder(tmp_path)
    for number, at_ns in enumerate((10, 20, 5, 30)):
        recorder.take(message(number, at_ns))
    recorder.close()
    with parts(tmp_path)[0].open("rb") as file:
        read = [(m.data[0], m.log_time, m.publish_time) for _, _, m in make_reader(file).iter_messages()]
    assert read == [(0, 10, 10), (1, 20, 20), (2, 20, 5), (3, 30, 30)]


def test_a_killed_recorder_leaves_what_was_written(tmp_path: Path) -> None:
    """After SIGKILL the file is read as far as it goes, and the next recorder begins another one."""
    text = (
        "import sys, time\nfrom pathlib import Path\nfrom tests.live.test_recording import *\n"
        "r = StreamRecorder(Path(sys.argv[1]))\n"
        "for n in range(200):\n    r.take(message(n, size=2000))\n"
        "while r.written < 1000:\n    time.sleep(0.01)\n"
        "print('written', flush=True)\ntime.sleep(60)\n"
    )
    process = subprocess.Popen([sys.executable, "-c", text, str(tmp_path)], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stdout.readline() == "written\n"
    process.send_signal(signal.SIGKILL)
    process.wait()
    from hectorscope.sources._mcap_scan import scan_mcap  # noqa: PLC0415

    read = [raw.data[0] for raw in scan_mcap(parts(tmp_path)[0])]
    assert read == list(range(len(read)))
    assert len(read) > 150
    StreamRecorder(tmp_path).close()
    assert len(parts(tmp_path)) == 1  # an empty one is removed


def test_a_file_that_was_just_begun_is_left_out(
    drive: Path, replay: Callable[..., Replay], tmp_path: Path
) -> None:
    """Who is killed right after a rotation leaves an empty file beside the whole ones."""
    recorder = StreamRecorder(tmp_path)
    with opened(replay(drive, *TOPICS, "--speed", "6").uri) as source:
        assert isinstance(source, Tappable)
        source.tap(recorder)
        received = list(islice(source.items(), 300))
    recorder.close()
    (tmp_path / "stream_0002.mcap").touch()
    with opened(tmp_path) as source:
        assert [plain(item) for item in islice(source.items(), 300)] == [plain(item) for item in received]


def sent(number: int) -> bytes:
    """What a message of the run on a full disk holds."""
    return Random(number).randbytes(4000)


def read_back(part: Path) -> list[bytes]:
    """The messages of a file, as far as it goes."""
    from hectorscope.sources._mcap_scan import scan_mcap  # noqa: PLC0415

    return [bytes(raw.data) for raw in scan_mcap(part)]


@pytest.mark.skipif(not hasattr(resource, "RLIMIT_FSIZE"), reason="needs a limit that stands for a full disk")
def test_a_full_disk_is_told_and_recording_goes_on_once_there_is_room(tmp_path: Path) -> None:
    """Nothing is raised into the stream, what was written is read, and the next file holds what comes then."""
    result = subprocess.run(
        [sys.executable, "-c", FULL, str(tmp_path)], capture_output=True, text=True, check=True
    )
    full, again = result.stdout.splitlines()
    assert "is not recorded at this moment" in full
    assert "File too large): make room" in full
    assert again == "no warning"
    before = read_back(parts(tmp_path)[0])
    assert 0 < len(before) < FIRST
    assert before == [sent(number) for number in range(len(before))]
    assert read_back(parts(tmp_path)[-1]) == [sent(number) for number in range(FIRST, FIRST + 20)]


def test_a_disk_that_was_too_slow_is_told_until_messages_are_written_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What finds no room while others wait is missing; the warning goes with the next ones that are written."""
    monkeypatch.setattr(stream_recorder, "MOST_WAITING", 20_000)
    recorder = StreamRecorder(tmp_path)
    for number in (1, 2):
        recorder.take(message(number, size=20_000))
    assert "is too slow" in recorder.warning
    wait_for(lambda: not recorder.warning)
    recorder.close()
    assert recorder.written


def test_a_message_that_cannot_be_written_costs_its_file_only(tmp_path: Path) -> None:
    """A time before 1970, which the format cannot hold, is told; the recording goes on in another file."""
    recorder = StreamRecorder(tmp_path, again_s=0.01)
    recorder.take(message(1, -5))
    wait_for(lambda: recorder.failed)
    assert "is not recorded at this moment" in recorder.warning
    recorder.take(message(2, size=50_000))
    wait_for(lambda: not recorder.failed)
    assert recorder.warning == ""
    recorder.close()
    assert read_back(parts(tmp_path)[-1]) == [bytes([2]) * 50_000]


def test_a_folder_that_cannot_be_had_is_refused(tmp_path: Path) -> None:
    """With the reason and the remedy."""
    (tmp_path / "file").touch()
    with pytest.raises(RecordError, match=r"cannot be written .*: choose another folder"):
        StreamRecorder(tmp_path / "file" / "folder")
