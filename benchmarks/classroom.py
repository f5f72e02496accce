"""A class on one server: many scripted browsers and some real ones follow a teacher while a recording plays at 1x.

    python -m benchmarks.classroom [--sockets 30] [--browsers 3] [--seconds 30]

The server is the real command in a process of its own. A scripted browser opens the page's WebSocket, reads all
that comes, and moves its camera; it draws nothing. One of the real browsers teaches, and changes its view often.
The recording begins again when all of them are there, so that it plays while it is measured.
"""

import argparse
import asyncio
import os
import random
import subprocess
import sys
import threading
import time
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import cycle

import msgspec.msgpack
import viser
from playwright.sync_api import Page, sync_playwright
from websockets.asyncio.client import connect
from websockets.exceptions import WebSocketException
from websockets.typing import Subprotocol

from benchmarks.page import cpu_seconds
from benchmarks.screenshots import SIZE
from tests.conftest import FLAGS, chromium_path

PORT = 8721
SETTLE_S = 30.0  # the kernels are loaded, and the pass ahead of what is shown is done
RESTARTED = "document.querySelector('.hs-clock b').textContent < '00:05'"
PLAYING = "!!document.querySelector('.hs-state.hs-playing')"
CAMERA_S = 0.5
PATIENCE_MS = 120_000
SILENT = "document.documentElement.classList.contains('hs-silent')"
AGREES = "hectorscope.own.get('gap')"


@dataclass
class Sockets:
    """Scripted browsers on a thread of their own. received: bytes; lost: connections that ended early."""

    count: int
    received: int = 0
    lost: int = 0
    _stop: threading.Event = field(default_factory=threading.Event)

    def __post_init__(self) -> None:
        self._thread = threading.Thread(target=lambda: asyncio.run(self._all()), daemon=True)

    def start(self) -> None:
        """Connect all of them."""
        self._thread.start()

    def stop(self) -> None:
        """End them."""
        self._stop.set()

    @property
    def running(self) -> bool:
        """Whether at least one is connected; not after an error of this program either."""
        return self._thread.is_alive()

    async def _all(self) -> None:
        await asyncio.gather(*(self._one(random.Random(seed)) for seed in range(self.count)))

    async def _one(self, rng: random.Random) -> None:
        """A browser, until `stop`. One that cannot connect, or whose connection ends, is lost."""
        protocol = Subprotocol(f"viser-v{viser.__version__}")
        try:
            async with connect(f"ws://127.0.0.1:{PORT}/", subprotocols=[protocol], max_size=None) as socket:
                due = time.monotonic()
                while not self._stop.is_set():
                    with suppress(TimeoutError):
                        self.received += len(await asyncio.wait_for(socket.recv(), CAMERA_S))
                    if time.monotonic() > due:
                        due = time.monotonic() + CAMERA_S * rng.uniform(1.0, 2.0)
                        await socket.send(msgspec.msgpack.encode(camera(rng)))
        except (OSError, WebSocketException):
            self.lost += 1


def camera(rng: random.Random) -> dict[str, object]:
    """What a page says when somebody turns its view."""
    places = {name: [rng.uniform(-9.0, 9.0) for _ in range(3)] for name in ("position", "look_at")}
    return {
        "type": "ViewerCameraMessage", "wxyz": [1.0, 0.0, 0.0, 0.0], **places, "up_direction": [0.0, 0.0, 1.0],
        "fov": 1.0, "near": 0.1, "far": 100.0, "image_height": 600, "image_width": 900,
    }  # fmt: skip


def settle(page: Page, address: str) -> None:
    """Open a page and wait until the map is drawn."""
    page.goto(address.replace("/#", "/?fixedDpr=0.3#") if "#" in address else f"{address}?fixedDpr=0.3")
    page.wait_for_function("!!window.hectorscope?.levels?.().places.length", timeout=PATIENCE_MS)


def follow_times(teacher: Page, students: list[Page], gap: float) -> list[float]:
    """Milliseconds from a change of the teacher's view until each student has it."""
    times = []
    begin = time.monotonic()
    teacher.evaluate("(gap) => hectorscope.own.set('gap', gap)", gap)
    for student in students:
        student.wait_for_function(f"(gap) => {AGREES} === gap", arg=gap, timeout=PATIENCE_MS)
        times.append(1e3 * (time.monotonic() - begin))
    return times


def play_from_the_start(page: Page) -> None:
    """The run begins again, and plays."""
    page.keyboard.press("r")
    page.wait_for_function(f"{RESTARTED} && {PLAYING}", timeout=PATIENCE_MS)


def watch(pid: int, crowd: Sockets, pages: list[Page], seconds: float) -> list[str]:
    """What was seen of a server while a recording played, in lines; SystemExit if that did not hold to the end."""
    teacher, *students = pages
    gaps = cycle(range(3, 18))
    play_from_the_start(teacher)
    begin, cpu, received = time.monotonic(), cpu_seconds(pid), crowd.received
    times: list[float] = []
    while time.monotonic() - begin < seconds:
        times += follow_times(teacher, students, next(gaps) / 10)
    wall = time.monotonic() - begin
    share, got = (cpu_seconds(pid) - cpu) / wall, (crowd.received - received) / wall / max(1, crowd.count) / 1024
    silent = sum(page.evaluate(SILENT) for page in pages)
    if not teacher.evaluate(PLAYING):
        raise SystemExit(f"the recording ended within {wall:.0f} s: take fewer --seconds")
    if crowd.count and not crowd.running:
        raise SystemExit(f"the scripted browsers ended early; {crowd.lost} of {crowd.count} were lost")
    times.sort()
    return [
        f"{crowd.count} sockets, {len(pages)} browsers, {wall:.0f} s at 1x: server {share:.2f} of a core",
        f"each socket got {got:.0f} KiB/s; {crowd.lost} were lost; {silent} of {len(pages)} pages silent",
        f"the teacher's view arrives after {times[len(times) // 2]:.0f} ms (median), {times[-1]:.0f} ms at most",
        f"load of the machine: {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores",
    ]


def measure(sockets: int, browsers: int, seconds: float) -> None:
    """Print what was seen."""
    command = [sys.executable, "-m", "hectorscope.cli.main", "demo", "arena", "--class", "--port", str(PORT)]
    crowd = Sockets(sockets)
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server, sync_playwright() as playwright:
        try:
            assert server.stdout is not None
            everyone, teacher = (server.stdout.readline().split()[-1] for _ in range(2))
            made = playwright.chromium.launch(executable_path=chromium_path(), args=FLAGS)
            pages = [made.new_context(viewport=SIZE).new_page() for _ in range(browsers)]
            for k, page in enumerate(pages):
                settle(page, everyone if k else teacher)
            crowd.start()
            time.sleep(SETTLE_S)
            print("\n".join(watch(server.pid, crowd, pages, seconds)))
        finally:
            crowd.stop()
            server.terminate()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sockets", type=int, default=30)
    parser.add_argument("--browsers", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=30.0)
    chosen = parser.parse_args()
    measure(chosen.sockets, chosen.browsers, chosen.seconds)


if __name__ == "__main__":
    main()
