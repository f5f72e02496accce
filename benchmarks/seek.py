"""How long a seek takes after one pass: from the command to the published snapshot, at random times.

    python -m benchmarks.seek [BAG] [--seeks 100] [--checkpoints 512]

Without a recording, the scenes of the demo are taken. BAG: what `hectorscope` takes.
"""

import argparse
import math
import random
import statistics
import time
from functools import partial
from pathlib import Path

from benchmarks.tables import table
from hectorscope.checks.sensor_check import CheckedSource
from hectorscope.inputs import SourceOptions
from hectorscope.run.checkpoints import BUDGET_MB
from hectorscope.run.warmup import load_everything
from hectorscope.session.commands import Command, Seek
from hectorscope.session.engine import Engine
from hectorscope.session.snapshot import Snapshot
from hectorscope.sources import open_source

DEMOS = (Path("demo_bags/arena.bag"), Path("demo_bags/littoral.mcap"))
LOOK_S = 0.001


def rest(engine: Engine, *commands: Command) -> Snapshot:
    """The snapshot once commands were obeyed and the engine rests."""
    for command in commands:
        engine.send(command)
    while True:
        now = engine.mailbox.latest
        if now and now.obeyed == engine.sent and now.playback.state in ("paused", "ended", "failed"):
            return now
        time.sleep(LOOK_S)


def measure(path: Path, seeks: int, budget: int) -> tuple[float, list[float]]:
    """Seconds of the pass, and milliseconds of each seek."""
    source = CheckedSource(partial(open_source, str(path)), SourceOptions())
    engine = Engine(source, speed=math.inf, checkpoints=budget)
    begun = time.perf_counter()
    engine.start()
    ended, passed = rest(engine), time.perf_counter() - begun
    where, taken = random.Random(1), []
    for _ in range(seeks):
        time_ns = where.randint(ended.playback.start_ns, ended.playback.end_ns or 0)
        begun = time.perf_counter()
        rest(engine, Seek(time_ns))
        taken.append(1e3 * (time.perf_counter() - begun))
    engine.stop()
    return passed, taken


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("bags", nargs="*", type=Path, default=DEMOS)
    parser.add_argument("--seeks", type=int, default=100)
    parser.add_argument("--checkpoints", type=int, default=BUDGET_MB, help="MiB")
    options = parser.parse_args()
    load_everything()
    rows = []
    for path in options.bags:
        passed, taken = measure(path, options.seeks, options.checkpoints)
        rows.append([path.name, f"{passed:.1f} s", f"{statistics.median(taken):.0f} ms", f"{max(taken):.0f} ms"])
    print(table(("recording", "one pass", "median seek", "longest seek"), rows))


if __name__ == "__main__":
    main()
