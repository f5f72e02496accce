"""A live run over a long time with four browsers: memory, threads and sockets of the program, each minute.

    python -m benchmarks.soak [--minutes 30] [--speed 3]

`hectorscope live` runs in a process of its own, with a journal, and maps what a Foxglove server replays: a drive
through the arena, 1081 beams at 20 Hz, so many times faster. One browser is a Chromium; three are sockets that
speak the protocol of the page, of which one rests two seconds after each message. Behind the first minutes, memory
counts as flat where it grows by 5 % at most. Memory is what the program has to hold (RssAnon and RssShmem of
Linux); pages of files, which the system takes back when it needs room, are told beside it (RssFile): libraries and
the rows of a long run. When the browsers have gone, threads and sockets have to be as many as before they came.
"""

import argparse
import subprocess
import sys
import tempfile
import time
import urllib.request
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from playwright.sync_api import sync_playwright

from benchmarks.memory import FILES, HELD, resident
from benchmarks.tables import table
from hectorscope.simulation import SimulateOptions, simulate
from tests.conftest import FLAGS, ROOT, chromium_path
from tests.live.browsers import Client
from tests.live.conftest import started
from tests.live.measurements import TOPICS

WARM_MINUTES = 4
FLAT = 0.05
MINUTE_S = 60.0
LOOKS = 12
PATIENCE_S = 60.0
SLOW_S = 2.0
TOKEN = "soak-and-look"
HEAD = ("minute", "memory", "pages of files", "threads", "sockets", "browsers", "scans", "dropped")


@dataclass(frozen=True, slots=True)
class Look:
    """At the program at one moment. memory, files: MiB."""

    memory: float
    files: float
    threads: int
    sockets: int
    browsers: int
    scans: int
    dropped: int

    def cells(self, minute: int) -> tuple[str, ...]:
        """Of the table."""
        counts = self.threads, self.sockets, self.browsers, self.scans, self.dropped
        return str(minute), f"{self.memory:.0f} MiB", f"{self.files:.0f} MiB", *map(str, counts)


def look(pid: int, url: str) -> Look:
    """As the system and the program tell it."""
    handles = [str(each.readlink()) for each in Path(f"/proc/{pid}/fd").iterdir()]
    figures = metrics(url)
    return Look(
        resident(HELD, pid),
        resident(FILES, pid),
        sum(1 for _ in Path(f"/proc/{pid}/task").iterdir()),
        sum(handle.startswith("socket:") for handle in handles),
        int(figures["hectorscope_browsers"]),
        int(figures["hectorscope_scans_total"]),
        int(figures["hectorscope_scans_dropped_total"]),
    )


def metrics(url: str) -> dict[str, float]:
    """The figures of the program without labels."""
    asked = urllib.request.Request(f"{url}/metrics", headers={"Authorization": f"Bearer {TOKEN}"})
    with urllib.request.urlopen(asked, timeout=PATIENCE_S) as answer:
        lines = [line.split() for line in answer.read().decode().splitlines() if not line.startswith("#")]
    return {line[0]: float(line[1]) for line in lines if len(line) == 2 and "{" not in line[0]}


@contextmanager
def program(robot: str, folder: Path) -> Iterator[tuple[int, str]]:
    """`hectorscope live`: its process, and its address without the token."""
    command = [sys.executable, "-m", "hectorscope.cli.main", "live", robot, "--port", "0"]
    command += ["--journal", str(folder / "journal"), "--token", TOKEN]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            address = next(line for line in process.stdout if "http://" in line).split()[-1]
            yield process.pid, address.partition("/?")[0]
        finally:
            process.terminate()


@contextmanager
def browsers(url: str) -> Iterator[None]:
    """Four of them in front of the page."""
    port = int(url.rsplit(":", 1)[1])
    with sync_playwright() as playwright, ExitStack() as stack:
        page = playwright.chromium.launch(executable_path=chromium_path(), args=FLAGS).new_page()
        page.goto(f"{url}/?token={TOKEN}")
        for pace in (0.0, 0.0, SLOW_S):
            stack.callback(Client(port, pace, cookie=f"hectorscope_{port}={TOKEN}").close)
        yield


def over_a_minute(pid: int, url: str) -> Look:
    """The last look of a minute, with its least memory: a checkpoint that is written takes some for a moment."""
    looks = []
    for _ in range(LOOKS):
        time.sleep(MINUTE_S / LOOKS)
        looks.append(look(pid, url))
    return replace(looks[-1], memory=min(each.memory for each in looks))


def until_same(pid: int, url: str, before: Look) -> Look:
    """The look once threads and sockets are as many as before, or patience ends."""
    ends = time.monotonic() + PATIENCE_S
    while (now := look(pid, url)).sockets > before.sockets and time.monotonic() < ends:
        time.sleep(1.0)
    return now


def soak(minutes: int, speed: float, folder: Path) -> tuple[list[Look], Look, Look]:
    """The looks of each minute, and those before the browsers came and behind them."""
    recording = folder / "drive.mcap"
    seconds = speed * MINUTE_S * (minutes + 2)
    simulate(SimulateOptions(scenario="arena", duration=seconds, scan_rate=20.0, out=recording))
    robot = started(recording, *TOPICS, "--speed", str(speed))
    try:
        with program(robot.uri, folder) as (pid, url):
            while not metrics(url)["hectorscope_scans_total"]:
                time.sleep(1.0)
            before, looks = look(pid, url), []
            with browsers(url):
                for minute in range(1, minutes + 1):
                    looks.append(over_a_minute(pid, url))
                    print(" | ".join(looks[-1].cells(minute)), flush=True)
            return looks, before, until_same(pid, url, before)
    finally:
        robot.kill()


def verdict(looks: list[Look], before: Look, after: Look) -> Iterator[str]:
    """What the looks say, in sentences."""
    warm, last = looks[min(WARM_MINUTES, len(looks)) - 1], looks[-1]
    grown = last.memory - warm.memory
    yield (
        f"Memory behind minute {min(WARM_MINUTES, len(looks))}: {grown:+.0f} MiB of {warm.memory:.0f} MiB"
        f" ({grown / warm.memory:+.1%}): {'flat' if grown <= FLAT * warm.memory else 'not flat'};"
        f" pages of files {last.files - warm.files:+.0f} MiB"
    )
    for what in ("threads", "sockets"):
        counts = (getattr(at, what) for at in (before, last, after))
        yield "{} before the browsers {}, with them {}, behind them {}".format(what.capitalize(), *counts)


def main() -> None:
    """Print a line each minute, the table and the verdict."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=int, default=30)
    parser.add_argument("--speed", type=float, default=3.0)
    given: Any = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        looks, before, after = soak(given.minutes, given.speed, Path(folder))
    print(table(HEAD, [at.cells(minute) for minute, at in enumerate(looks, 1)]))
    print("\n".join(verdict(looks, before, after)))


if __name__ == "__main__":
    main()
