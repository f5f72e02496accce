"""Runs every compiled kernel once, so that the first real scan does not wait for the compiler."""

import gc
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
from numba.core.dispatcher import Dispatcher

from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from slam_core.config import SlamConfig, with_value
from slam_core.localization.prior_map import PriorMap, saved_levels
from slam_core.measurements import Height, Imu, LaserScan, Measurement, Odometry

PATIENCE_S = 3.0  # what was compiled before is loaded sooner
PERIOD_S = 0.25
# Objects made before the collector looks for cycles among them: a step makes many, and no cycle.
GARBAGE = 20_000

# For another process, as numba compiles one kernel after the other. Both find what is compiled where it is kept.
HELP = "import sys; sys.path[:] = {!r}; from hectorscope.run.warmup import _help; _help()"

Report = Callable[[str], None]


def warm_up(report: Report = lambda _: None) -> None:
    """A few scans of a small made-up room through every branch.

    When it takes longer it reports its progress, on stderr and to `report` (from another thread, while it runs).
    Another process then begins with what inertial data needs, which therefore comes last here.
    """
    with _watched(report):
        for inertial in (False, True):
            _run(inertial)
    gc.freeze()  # what is loaded by now stays: the garbage collector may pass it over
    gc.set_threshold(GARBAGE)


@contextmanager
def _watched(report: Report) -> Iterator[None]:
    done = threading.Event()

    moving = sys.stderr.isatty()  # elsewhere one line is enough

    def watch() -> None:
        said, wait = "", PATIENCE_S
        helper: subprocess.Popen[bytes] | None = None
        while not done.wait(wait):
            helper = helper or _helper()
            progress, wait = _progress(), PERIOD_S
            if progress != said:
                report(progress)
                if moving or not said:
                    print(f"\r{progress}", end="" if moving else "\n", file=sys.stderr, flush=True)
                said = progress
        if moving and said:
            print(file=sys.stderr)
        if helper:
            helper.communicate()  # it ends when its input does

    watcher = threading.Thread(target=watch, name="watching the compiler", daemon=True)
    watcher.start()
    try:
        yield
    finally:
        done.set()
        watcher.join()


def _helper() -> subprocess.Popen[bytes]:
    """In a session of its own: an interrupt at the terminal is not for it. It ends when its input does."""
    command = [sys.executable, "-c", HELP.format(sys.path)]
    pipe, quiet = subprocess.PIPE, subprocess.DEVNULL
    return subprocess.Popen(command, stdin=pipe, stdout=quiet, stderr=quiet, start_new_session=True)


def _help() -> None:
    """What the helper does, for as long as the process lives that began it."""

    def watch() -> None:
        os.read(sys.stdin.fileno(), 1)  # until the other end is closed
        os._exit(1)

    threading.Thread(target=watch, name="watching who is helped", daemon=True).start()
    _run(inertial=True)


def _progress() -> str:
    kernels = [kernel for kernel in _kernels() if kernel.targetoptions.get("inline") != "always"]
    compiled = sum(bool(kernel.signatures) for kernel in kernels)
    return f"{compiled} of {len(kernels)} kernels compiled (first start only)"


def _kernels() -> list[Dispatcher]:
    """What numba compiles of the core, so far as it is loaded."""
    modules = [module for name, module in list(sys.modules.items()) if name.startswith("slam_core.kernels.")]
    values = [value for module in modules for value in vars(module).values()]
    return list({id(value): value for value in values if isinstance(value, Dispatcher)}.values())


def _run(inertial: bool) -> None:
    # The surfaces are looked for in every scan.
    config = with_value(with_value(SlamConfig(), "map.size", 256), "matcher.weak_observability_threshold", 1.0)
    prior_map = None
    for method in ("hessian", "sampled"):
        pipeline = Pipeline(Settings(with_value(config, "matcher.covariance", method)), prior_map=prior_map)
        for measurement in _room(inertial):
            for ready in pipeline.admit(measurement):
                pipeline.step(ready)
        for ready in pipeline.flush():
            pipeline.step(ready)
        prior_map = PriorMap("the room", saved_levels(pipeline.slam.map))  # the second run seeks its place there


def _room(inertial: bool) -> list[Measurement]:
    """Two seconds at rest in the middle of a room of 4 by 4 metres: a scan every 0.1 s, other data besides."""
    angles = np.linspace(-np.pi, np.pi, 181)
    ranges = (2.0 / np.maximum(np.abs(np.cos(angles)), np.abs(np.sin(angles)))).astype(np.float32)
    ranges[:3] = np.inf
    measurements: list[Measurement] = []
    for tick in range(201):
        stamp_ns = tick * 10_000_000
        if inertial:
            measurements.append(Imu(stamp_ns, np.zeros(3), np.array([0.0, 0.0, 9.80665])))
            measurements.append(Height(stamp_ns, 0.0))
        if tick % 10 == 0:
            measurements.append(Odometry(stamp_ns, np.zeros(2), 0.0))
            seen = ranges if tick < 200 else 0.4 * ranges  # the last one fits nowhere: it is searched for
            measurements.append(LaserScan(stamp_ns, seen, -np.pi, float(angles[1] - angles[0]), 1e-5, 0.1, 30.0))
    return measurements
