"""A class on one server: many scripted browsers and some real ones follow a teacher while a recording plays at 1x.

    python -m benchmarks.classroom [--sockets 30] [--browsers 3] [--seconds 30]

The server is the real command in a process of its own. A scripted browser opens the page's WebSocket, reads all
that comes, and moves its camera; it draws nothing. One of the real browsers teaches, and changes its view often.
"""

import argparse
import asyncio
import random
import subprocess
import sys
import threading
import time
from dataclasses import dataclass, field

import msgspec.msgpack
import viser
from playwright.sync_api import Page, sync_playwright
from websockets.asyncio.client import connect
from websockets.typing import Subprotocol

from benchmarks.page import cpu_seconds
from benchmarks.screenshots import FLAGS, SIZE
from tests.conftest import chromium_path

PORT = 8721
SETTLE_S = 30.0  # the kernels are loaded, and the pass ahead of what is shown is done
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

    def run(self) -> None:
        """Until `stop`."""
        asyncio.run(self._all())

    def stop(self) -> None:
        """End them."""
        self._stop.set()

    async def _all(self) -> None:
        await asyncio.gather(*(self._one(random.Random(seed)) for seed in range(self.count)))

    async def _one(self, rng: random.Random) -> None:
        protocol = Subprotocol(f"viser-v{viser.__version__}")
        async with connect(f"ws://127.0.0.1:{PORT}/", subprotocols=[protocol], max_size=None) as socket:
            due = time.monotonic()
            while not self._stop.is_set():
                try:
                    message = await asyncio.wait_for(socket.recv(), CAMERA_S)
                    self.received += len(message)
                except TimeoutError:
                    pass
                except Exception:
                    self.lost += 1
                    return
                if time.monotonic() > due:
                    due = time.monotonic() + CAMERA_S * rng.uniform(1.0, 2.0)
                    await socket.send(msgspec.msgpack.encode(camera(rng)))


def camera(rng: random.Random) -> dict[str, object]:
    """What a page says when somebody turns its view."""
    places = {name: [rng.uniform(-9.0, 9.0) for _ in range(3)] for name in ("position", "look_at")}
    return {
        "type": "ViewerCameraMessage", "wxyz": [1.0, 0.0, 0.0, 0.0], **places, "up_direction": [0.0, 0.0, 1.0],
        "fov": 1.0, "near": 0.1, "far": 100.0, "image_height": 600, "image_width": 900,
    }  # fmt: skip


def settled(page: Page, address: str) -> Page:
    """The page, once the map is drawn."""
    page.goto(address.replace("/#", "/?fixedDpr=0.3#") if "#" in address else f"{address}?fixedDpr=0.3")
    page.wait_for_function("!!window.hectorscope?.levels?.().places.length", timeout=PATIENCE_MS)
    return page


def follow_times(teacher: Page, students: list[Page], rounds: int) -> list[float]:
    """Milliseconds from a change of the teacher's view until each student has it."""
    times = []
    for k in range(rounds):
        gap = round(0.3 + 0.1 * (k % 15), 2)
        begin = time.monotonic()
        teacher.evaluate("(gap) => hectorscope.own.set('gap', gap)", gap)
        for student in students:
            student.wait_for_function(f"(gap) => {AGREES} === gap", arg=gap, timeout=PATIENCE_MS)
            times.append(1e3 * (time.monotonic() - begin))
    return times


def measure(sockets: int, browsers: int, seconds: float) -> None:
    """Print what was seen."""
    command = [
        *(sys.executable, "-m", "hectorscope.cli.main"),
        *("demo", "arena", "--class", "--port", str(PORT)),
    ]
    crowd = Sockets(sockets)
    thread = threading.Thread(target=crowd.run, daemon=True)
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server, sync_playwright() as playwright:
        try:
            assert server.stdout is not None
            lines = [server.stdout.readline().split()[-1] for _ in range(2)]
            made = playwright.chromium.launch(executable_path=chromium_path(), args=FLAGS)
            pages = [made.new_context(viewport=SIZE).new_page() for _ in range(browsers)]
            teacher, *students = [settled(p, lines[0] if k else lines[1]) for k, p in enumerate(pages)]
            thread.start()
            time.sleep(SETTLE_S)
            begin, cpu, received = time.monotonic(), cpu_seconds(server.pid), crowd.received
            times: list[float] = []
            while time.monotonic() - begin < seconds:
                times += follow_times(teacher, students, 5)
            wall = time.monotonic() - begin
            share = (cpu_seconds(server.pid) - cpu) / wall
            rate = (crowd.received - received) / wall / max(1, sockets) / 1024
            alive = sum(page.evaluate("hectorscope.linked()") for page in pages)
            silent = sum(page.evaluate(SILENT) for page in pages)
        finally:
            crowd.stop()
            server.terminate()
    times.sort()
    print(f"{sockets} sockets, {browsers} browsers, {wall:.0f} s at 1x: server {share:.2f} of a core")
    print(f"each socket got {rate:.0f} KiB/s; {crowd.lost} were lost; {alive} pages alive, {silent} silent")
    print(f"the teacher's view arrives after {times[len(times) // 2]:.0f} ms (median), {times[-1]:.0f} ms at most")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sockets", type=int, default=30)
    parser.add_argument("--browsers", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=30.0)
    chosen = parser.parse_args()
    measure(chosen.sockets, chosen.browsers, chosen.seconds)


if __name__ == "__main__":
    main()
