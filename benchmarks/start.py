"""How soon something is there: on the page, at the end of a run, and on the first start of all.

    python -m benchmarks.start [--scene arena] [--runs 5]

Every command runs in a process of its own, as a person's would, who has not installed what only benchmarks need:
numba loads scipy where it finds it, which takes some tenths of a second. The browser, a real Chromium, is open
already and asks for the page once it is served; how long it takes to open is told apart. For a first start its
profile is new; for the others it has shown the page before, so that it has the page's scripts. Two runs before do
not count.
"""

import argparse
import os
import resource
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from typing import NamedTuple, get_args

from playwright.sync_api import BrowserContext, Playwright, sync_playwright

from benchmarks import tables
from benchmarks.page import cpu_seconds
from benchmarks.screenshots import SIZE
from hectorscope.cli.opening import Scene, demo_bag
from tests.conftest import FLAGS, chromium_path

PORT = 8721
RUNS = 5
WARMING = 2  # runs before, after which the browser keeps the compiled scripts
COLD_RUNS = 3  # of the first start
PATIENCE_S = 180.0
# Its nodes are there before it is anywhere, and seen until they are hidden; from the first scan on that has a pose
# the hull is seen, and the page says that the run is no longer loading or what it waits for now.
ROBOT = """(() => {
    let node = window.__viserMutable?.nodeRefFromName?.['/robot/hull'];
    const state = document.querySelector('.hs-run .hs-state');
    const begun = state && (state.textContent !== 'loading' || document.querySelector('.hs-start-line'));
    const found = Boolean(node && begun);
    for (; node; node = node.parent) if (!node.visible) return false;
    return found;
})()"""
# The clock of the recording in the status bar has gone on for some scans since it was first seen.
MOVING = """(() => {
    const clock = document.querySelector('.hs-run .hs-time').lastChild.textContent;
    const [minutes, seconds] = clock.split(':').map(Number);
    window.firstSeen ??= 60 * minutes + seconds;
    return 60 * minutes + seconds > window.firstSeen + 0.45;
})()"""
NEXT_FRAME = "new Promise(requestAnimationFrame)"
COMPILE = "from hectorscope.run.warmup import load_everything; load_everything()"
MISSING = "raise ImportError('not in the environment that the README makes')"


class Took(NamedTuple):
    """Seconds of the wall clock, and of the command's CPU by then."""

    wall: float
    cpu: float


@contextmanager
def plainly() -> Iterator[dict[str, str]]:
    """An environment for commands in which there is no scipy."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "scipy.py").write_text(MISSING, encoding="utf-8")
        paths = folder, *filter(None, [os.environ.get("PYTHONPATH")])
        yield {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}


def shown(profile: BrowserContext, scene: Scene, *, is_cold: bool = False) -> tuple[Took, Took, Took]:
    """Until the page of a recording is served, until its first scan is drawn, and until the second is.

    is_cold: no kernel was compiled before. The CPU is that of the command and of the process that helps it.
    """
    begin = time.monotonic()
    command = [sys.executable, "-m", "hectorscope.cli.main", "demo", scene, "--port", str(PORT)]
    with (
        plainly() as environment,
        tempfile.TemporaryDirectory() as cache,
        subprocess.Popen(
            command,
            env=environment | ({"NUMBA_CACHE_DIR": cache} if is_cold else {}),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        ) as server,
    ):
        try:
            page = profile.new_page()
            _serves(begin + PATIENCE_S)
            served = Took(time.monotonic() - begin, cpu_seconds(server.pid))
            page.goto(f"http://127.0.0.1:{PORT}/?fixedDpr=0.3", wait_until="commit")
            page.wait_for_function(ROBOT, timeout=PATIENCE_S * 1000, polling=20)
            page.evaluate(NEXT_FRAME)
            drawn = Took(time.monotonic() - begin, tree_seconds(server.pid))
            page.wait_for_function(MOVING, timeout=PATIENCE_S * 1000, polling=20)
            moving = Took(time.monotonic() - begin, tree_seconds(server.pid))
            page.close()
        finally:
            server.terminate()
    return served, drawn, moving


@contextmanager
def profile(playwright: Playwright) -> Iterator[tuple[BrowserContext, float]]:
    """A Chromium with a new profile, and the seconds that it took to open."""
    with tempfile.TemporaryDirectory() as folder:
        begin = time.monotonic()
        context = playwright.chromium.launch_persistent_context(
            folder, executable_path=chromium_path(), args=FLAGS, viewport=SIZE
        )
        yield context, time.monotonic() - begin
        context.close()


def tree_seconds(pid: int) -> float:
    """CPU of a process and of those that it began."""
    children = Path(f"/proc/{pid}/task").glob("*/children")
    pids = {pid, *(int(child) for file in children for child in file.read_text(encoding="ascii").split())}
    return sum(map(cpu_seconds, pids))


def _serves(until: float) -> None:
    """Wait until somebody listens, as a person waits for the address: a browser that tries takes the processor."""
    while True:
        try:
            socket.create_connection(("127.0.0.1", PORT)).close()
        except ConnectionRefusedError:
            if time.monotonic() > until:
                raise
            time.sleep(0.02)
        else:
            return


def run(scene: Scene) -> Took:
    """The whole command that processes a recording, from its start to its end."""
    with tempfile.TemporaryDirectory() as folder:
        return _finished(["-m", "hectorscope.cli.main", "run", str(demo_bag(scene)), "--out", folder])


def cold() -> Took:
    """Until every kernel is compiled, where none was."""
    with tempfile.TemporaryDirectory() as folder:
        return _finished(["-c", COMPILE], NUMBA_CACHE_DIR=folder)


def _finished(arguments: list[str], **environment: str) -> Took:
    with plainly() as plain:
        begin, before = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, *arguments], env=plain | environment, check=True, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    work = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Took(time.monotonic() - begin, work)


def measure(scene: Scene = "arena", runs: int = RUNS) -> str:
    """The table; without a browser only of what needs none."""
    rows: list[tuple[str, list[Took]]] = []
    run(scene)
    if chromium_path():
        with sync_playwright() as playwright:
            with profile(playwright) as (used, opened):
                starts = [shown(used, scene) for _ in range(runs + WARMING)][WARMING:]
            colds = []
            for _ in range(COLD_RUNS):
                with profile(playwright) as (new, _opened):
                    colds.append(shown(new, scene, is_cold=True))
        drawn = [drawn for _, drawn, _ in starts]
        rows += [
            ("`demo` on the first start: first scan drawn, in an open browser", [drawn for _, drawn, _ in colds]),
            ("`demo` on the first start: scans go by", [moving for _, _, moving in colds]),
            ("`demo`: page served", [served for served, _, _ in starts]),
            ("`demo`: robot drawn, in an open browser", drawn),
            ("`demo`: robot drawn, with the start of the browser", [Took(t.wall + opened, t.cpu) for t in drawn]),
        ]
    rows.append(("`run`: everything written", [run(scene) for _ in range(runs)]))
    rows.append(("every kernel compiled by one process", [cold()]))
    head = ("from the command to", "wall, s", "at best", "its CPU, s")
    return tables.table(head, ((name, *_figures(took)) for name, took in rows))


def _figures(times: list[Took]) -> Iterator[str]:
    """The median of the wall clock, its best, and the median of the CPU."""
    walls, work = zip(*times, strict=True)
    return (f"{seconds:.2f}" for seconds in (median(walls), min(walls), median(work)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", choices=get_args(Scene), default="arena")
    parser.add_argument("--runs", type=int, default=RUNS)
    args = parser.parse_args()
    print(measure(args.scene, args.runs))


if __name__ == "__main__":
    main()
