"""Kills a live run with a journal at random moments, and measures what the next start has of it.

    python -m benchmarks.kills [--kills 20] [--seed 1]

Each time a server replays arena.bag, a run is killed by SIGKILL, and the journal is read as the next start reads
it. Prints the time from the last shown scan to the last one that is there again, and whether there
was a checkpoint. A damaged one ends it with an error.
"""

import argparse
import random
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from hectorscope.cli.opening import demo_bag
from hectorscope.run.settings import Settings
from hectorscope.session import journal_files
from hectorscope.session.checkpoint_file import read_checkpoint
from hectorscope.session.journal import resumed
from tests.conftest import ROOT
from tests.live.journals import RUN, reopen

TOPICS = ("/tf_static", "/scan", "/imu/data_raw", "/pressure")
EARLIEST_S, LATEST_S = 2.0, 20.0  # after the first scan


def killed(root: Path, after_s: float) -> tuple[float, bool]:
    """Kill a run so long after its first scan.

    The seconds of the recording that the next start does not have, and whether there was a checkpoint.
    """
    server = subprocess.Popen(
        [sys.executable, "-m", "tests.live.replay_server", str(demo_bag("arena")), "--topics", *TOPICS],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert server.stdout is not None
    uri = f"ws://127.0.0.1:{server.stdout.readline().split()[1]}"
    run = subprocess.Popen([sys.executable, "-c", RUN, uri, str(root)], stdout=subprocess.PIPE, text=True)
    assert run.stdout is not None
    last_ns, ends = 0, float("inf")
    for line in run.stdout:
        last_ns = int(line.split()[1])
        ends = min(ends, time.monotonic() + after_s)
        if time.monotonic() >= ends:
            break
    for process in (run, server):
        process.send_signal(signal.SIGKILL)
        process.wait()
    (folder,) = journal_files.journals(root)
    # A damaged one raises here; `resumed` would leave it out.
    has_checkpoint = read_checkpoint(folder) is not None
    again = resumed(folder, reopen, Settings(), None)
    return (last_ns - again.pipeline.time_ns) / 1e9, has_checkpoint


def main() -> None:
    """Print a line for each kill, and the worst."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    moments = random.Random(given.seed)
    missing, checkpoints = [], 0
    for number in range(given.kills):
        after_s = moments.uniform(EARLIEST_S, LATEST_S)
        with tempfile.TemporaryDirectory() as folder:
            gone, has_checkpoint = killed(Path(folder), after_s)
        missing.append(gone)
        checkpoints += has_checkpoint
        words = "with a checkpoint" if has_checkpoint else "without a checkpoint"
        print(f"{number + 1:3}: killed after {after_s:5.2f} s, {gone:5.2f} s are missing, {words}", flush=True)
    print(f"median {statistics.median(missing):.2f} s, most {max(missing):.2f} s")
    print(f"{checkpoints} of {given.kills} had a checkpoint, and none was damaged")


if __name__ == "__main__":
    main()
