"""The live path at full length: latency, drops, and whether the trajectory is that of the recording.

    python -m benchmarks.live [RECORDING] [--speed 1]

Replays a recording (the arena's, unless told otherwise) on a real Foxglove server in a process of its own and
maps from the stream. Latencies count from the moment when the server is given a scan: until the source hands it
out, and until its pose is there, which has to wait for inertial data that covers the sweep.
"""

import argparse
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from hectorscope.cli.opening import demo_bag
from hectorscope.inputs import Item, SourceOptions
from hectorscope.run.headless import run_headless
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.run.warmup import load_everything
from hectorscope.session.feeder import Feeder
from hectorscope.sources._live import LiveSource
from hectorscope.sources.bag import BagSource, open_bag
from hectorscope.sources.foxglove import FoxgloveWire
from slam_core.measurements import LaserScan
from tests.conftest import ROOT

SILENCE_S = 3.0


class TimedSource(LiveSource):
    """Notes when each scan was handed out."""

    def __init__(self, uri: str) -> None:
        super().__init__(uri, SourceOptions(), FoxgloveWire(uri))
        self.arrived: dict[int, int] = {}

    def items(self) -> Iterator[Item]:
        """Measurements as they arrive."""
        for item in super().items():
            if isinstance(item, LaserScan):
                self.arrived[item.stamp_ns] = time.monotonic_ns()
            yield item


def map_live(uri: str) -> tuple[Pipeline, TimedSource, Feeder, dict[int, int]]:
    """Map until the stream falls silent; when each scan's pose was there."""
    source, pipeline, done = TimedSource(uri), Pipeline(Settings()), {}
    feeder = Feeder(source)
    heard = time.monotonic()
    while not pipeline.scans or time.monotonic() - heard < SILENCE_S:
        item = feeder.get(0.02)
        if item is None:
            continue
        heard = time.monotonic()
        for measurement in pipeline.admit(item):
            pipeline.step(measurement)
            if isinstance(measurement, LaserScan):
                done[measurement.stamp_ns] = time.monotonic_ns()
    source.close()
    feeder.close()
    return pipeline, source, feeder, done


def scan_stamps(bag: BagSource) -> list[int]:
    return [item.stamp_ns for item in bag.items() if isinstance(item, LaserScan)]


def show(name: str, times: dict[int, int], sent: dict[int, int]) -> None:
    latency = np.array([times[stamp] - sent[stamp] for stamp in times]) * 1e-6
    p50, p99 = np.percentile(latency, [50, 99])
    print(f"{name:24} p50 {p50:7.2f} ms   p99 {p99:7.2f} ms   max {latency.max():7.2f} ms   n {len(latency)}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("recording", type=Path, nargs="?")
    parser.add_argument("--speed", type=float, default=1.0)
    args = parser.parse_args()
    recording = Path(args.recording or demo_bag("arena")).resolve()
    bag = open_bag(recording, SourceOptions())
    topics, stamps = sorted(bag.roles.topics()), scan_stamps(bag)
    load_everything()
    with tempfile.TemporaryDirectory() as folder:
        sent_file = Path(folder) / "sent"
        server_of = [sys.executable, "-m", "tests.live.replay_server", str(recording)]
        command = [*server_of, "--speed", str(args.speed), "--stamps", str(sent_file), "--topics", *topics]
        server = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
        assert server.stdout is not None
        try:
            port = server.stdout.readline().split()[1]
            pipeline, source, feeder, done = map_live(f"ws://127.0.0.1:{port}")
            lines = [line.split() for line in sent_file.read_text().splitlines()]
        finally:
            server.kill()
    sent = dict(zip(stamps, (int(at) for topic, at in lines if topic == bag.roles.scan), strict=True))
    show("scan handed out", source.arrived, sent)
    show("pose known", done, sent)
    report = source.report
    print(
        f"received {sum(report.read.values())}, dropped {feeder.dropped}, skipped {sum(report.skipped.values())}"
    )
    if feeder.dropped:
        print("poses not compared: scans were dropped, the machine was too busy")
        return
    reference, _ = run_headless(bag, Settings())
    rows = pipeline.scans  # the last few wait for inertial data that never comes
    same = pipeline.trajectory[:, 1:].tobytes() == reference.trajectory[:rows, 1:].tobytes()
    print(f"poses {rows} of {reference.scans}: {'the same bytes' if same else 'DIFFERENT'} as from the recording")


if __name__ == "__main__":
    main()
