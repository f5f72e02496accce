"""What the page costs: the server's share of one core and the bytes on the socket, at 1x with one browser.

    python -m benchmarks.page [--scene arena] [--seconds 30]

The server is the real command in a process of its own; the cost of the browser, a real Chromium, is not counted.
"""

import argparse
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import get_args

from playwright.sync_api import Page, sync_playwright

from benchmarks.screenshots import SIZE
from hectorscope.cli.opening import Scene
from tests.conftest import FLAGS, chromium_path

PORT = 8719
TICKS = os.sysconf("SC_CLK_TCK")
SETTLE_S = 20.0  # by then the pass ahead of what is shown is done, also on a busy machine


def cpu_seconds(pid: int) -> float:
    """User and system time of a process so far."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def count_bytes(page: Page) -> list[int]:
    """Sizes of the socket's frames, growing while the page is open."""
    sizes: list[int] = []
    page.on("websocket", lambda socket: socket.on("framereceived", lambda data: sizes.append(len(data))))
    return sizes


def measure(scene: Scene, seconds: float) -> tuple[float, float]:
    """Share of one core and KiB/s while the scene plays at 1x."""
    command = [sys.executable, "-m", "hectorscope.cli.main", "demo", scene, "--port", str(PORT)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server, sync_playwright() as playwright:
        try:
            assert server.stdout is not None
            server.stdout.readline()
            browser = playwright.chromium.launch(executable_path=chromium_path(), args=FLAGS)
            page = browser.new_page(viewport=SIZE)
            sizes = count_bytes(page)
            page.goto(f"http://127.0.0.1:{PORT}/?fixedDpr=0.3")
            page.wait_for_timeout(1e3 * SETTLE_S)
            begin, cpu, first = time.monotonic(), cpu_seconds(server.pid), len(sizes)
            page.wait_for_timeout(1e3 * seconds)
            wall = time.monotonic() - begin
            share = (cpu_seconds(server.pid) - cpu) / wall
            received = sum(sizes[first:]) / wall / 1024
            browser.close()
        finally:
            server.terminate()
    return share, received


def main() -> None:
    """Measure the scenes that were asked for and print a line each."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", choices=get_args(Scene), action="append")
    parser.add_argument("--seconds", type=float, default=30.0)
    arguments = parser.parse_args()
    for scene in arguments.scene or get_args(Scene):
        share, received = measure(scene, arguments.seconds)
        print(f"{scene}: {100 * share:.0f} % of one core, {received:.0f} KiB/s", flush=True)


if __name__ == "__main__":
    main()
