"""How long a warm start takes: from the command to the first frame in which a browser shows the robot.

    python -m benchmarks.start [--scene arena] [--runs 3]

The command runs in a process of its own, as a person's would; the browser, a real Chromium, is open already and
asks for the page until it is served. A run before compiles what is not compiled yet and does not count.
"""

import argparse
import subprocess
import sys
import time
from typing import get_args

from playwright.sync_api import Browser, Error, Page, sync_playwright

from app.cli import Scene
from benchmarks.page import cpu_seconds
from benchmarks.screenshots import FLAGS, SIZE
from tests.conftest import chromium_path

PORT = 8721
PATIENCE_S = 180.0
ROBOT = "window.__viserMutable?.nodeRefFromName?.['/robot']"
NEXT_FRAME = "new Promise(requestAnimationFrame)"


def measure(browser: Browser, scene: Scene) -> tuple[float, float, float]:
    """Seconds until the page is served and until the robot is drawn, and the command's seconds of CPU by then."""
    begin = time.monotonic()
    command = [sys.executable, "-m", "app.cli", "demo", scene, "--port", str(PORT)]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as server:
        try:
            page = browser.new_page(viewport=SIZE)
            _open(page, begin + PATIENCE_S)
            served = time.monotonic() - begin
            page.wait_for_function(ROBOT, timeout=PATIENCE_S * 1000, polling=20)
            page.evaluate(NEXT_FRAME)
            drawn, work = time.monotonic() - begin, cpu_seconds(server.pid)
            page.close()
        finally:
            server.terminate()
    return served, drawn, work


def _open(page: Page, until: float) -> None:
    """Ask for the page until there is one."""
    while True:
        try:
            page.goto(f"http://127.0.0.1:{PORT}/?fixedDpr=0.3", wait_until="commit")
        except Error:
            if time.monotonic() > until:
                raise
            time.sleep(0.02)
        else:
            return


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", choices=get_args(Scene), default="arena")
    parser.add_argument("--runs", type=int, default=3)
    args = parser.parse_args()
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium_path(), args=FLAGS)
        for run in range(args.runs + 1):
            served, drawn, work = measure(browser, args.scene)
            name = f"run {run}" if run else "before"
            print(
                f"{name}: served after {served:.2f} s, robot drawn after {drawn:.2f} s, {work:.2f} s of CPU",
                flush=True,
            )
        browser.close()


if __name__ == "__main__":
    main()
