"""Journals for tests: runs that keep one, those that are killed, and what is left of them."""

import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from hectorscope.inputs import Source, SourceOptions
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.run.warmup import load_everything
from hectorscope.session import journal_files
from hectorscope.session.checkpoint_file import read_checkpoint
from hectorscope.session.engine import Engine
from hectorscope.session.journal import Journal
from hectorscope.session.station import Station
from hectorscope.sources import open_source
from tests.engines import running
from tests.live.measurements import GIVE_UP_S, opened, poses

RUN = """
import sys
from pathlib import Path
from tests.live.journals import run_for_ever
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


def is_paused(folder: Path) -> bool:
    """Whether the newest checkpoint is of a run that lets scans go by."""
    saved = read_checkpoint(folder)
    return saved is not None and saved.paused


@contextmanager
def kept(uri: str, root: Path) -> Iterator[tuple[Engine, Journal]]:
    """A live run with a journal."""
    journal = Journal(root, "a", reopen)
    with opened(uri) as source, running(source, Settings(), station=Station(journal=journal)) as engine:
        yield engine, journal
