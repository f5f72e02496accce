"""Loads the kernels of the first scan, or compiles them on the first start; the others follow during the run.
A stream does not wait for a kernel: all of them are there before it begins.

numba compiles one kernel after the other, so another process compiles those of the filter meanwhile, and then the
rest. Both find what is compiled where it is kept.
"""

import gc
import os
import subprocess
import sys
import threading
from typing import Any, cast

import numpy as np
from numba.core import event

from hectorscope.run.pipeline import Pipeline
from hectorscope.run.report import Report
from hectorscope.run.settings import Settings
from slam_core.config import SlamConfig, with_value
from slam_core.kernels.range_noise import BANDS, learn_noise
from slam_core.kernels.straight_walls import smooth
from slam_core.localization.along_walls import best_along
from slam_core.localization.dynamic_beams import foreground
from slam_core.localization.few_beams import confirmed
from slam_core.localization.placements import KeptScan, Placements, Usual
from slam_core.localization.prior_map import PriorMap, saved_levels
from slam_core.mapping.mapper import Mapper
from slam_core.mapping.pyramid import Pyramid
from slam_core.matching.landscape import costs
from slam_core.matching.matcher import coarse_to_fine
from slam_core.measurements import GroundDistance, Height, Imu, LaserScan, Measurement, Odometry
from slam_core.navigation.ego_motion import EgoMotion
from slam_core.results import ACCEPTED, PlanarGaussian
from slam_core.scan.stabilise import directions, stabilise

FIRST = 55  # functions of ours that the first scan has compiled, with those that they call
ALL = 135  # that every kernel has
# Objects made before the collector looks for cycles among them: a step makes many, and no cycle.
GARBAGE = 20_000
PERIOD_S = 0.25
POLITE = 10  # added to the helper's niceness once the run needs the processor
HELP = "import sys; sys.path[:] = {!r}; from hectorscope.run.warmup import _help; _help()"
READY = "ready"

listen: Any = event.register  # numba has no types for it


def _untold(text: str, share: float | None = None) -> None:
    """Nobody wants to know."""


def warm_up(report: Report = _untold, *, everything: bool = False) -> None:
    """Load or compile what the first scan needs, or everything that a run can need.

    What is compiled then or later is told to `report` and on stderr; a start that compiles nothing says nothing.
    """
    _compiler.report = report
    with _compiler.preparing(ALL if everything else FIRST):
        _first_map()
    if everything:
        load_everything()  # what the helper has compiled, and here what an earlier start did not come to
    _spare_collector()


class _Compiler(event.Listener):
    """Hears of every function that is compiled here or by the helper, which begins with the first one."""

    def __init__(self) -> None:
        self.report: Report = _untold
        self._is_first = self._is_told = False
        self._helper: subprocess.Popen[str] | None = None
        self._ready = threading.Event()
        self._depth = self._done = 0
        self._wanted = FIRST
        self._share = 0.0  # of what is wanted, as last told
        listen("numba:compile", self)

    def preparing(self, wanted: int) -> "_Compiler":
        """A context: within it so many functions are prepared, and at its end that is so."""
        self._wanted, self._share = wanted, 0.0
        return self

    def __enter__(self) -> None:
        self._is_first = True

    def __exit__(self, *_: object) -> None:
        while self._helper is not None and not self._ready.wait(PERIOD_S):
            self._tell()
        if self._done and self._share < 1.0:  # some were loaded, or the other process compiled the last one
            self._done = self._wanted
            self._tell()
        self._is_first = False
        if self._done:
            self.report("")

    def on_start(self, compilation: event.Event) -> None:
        """Whoever waits is told what for, by the thread that waits."""
        self._depth += 1
        if self._depth > 1:
            return
        if self._is_first:
            self._begin_helper()
            self._tell()
        else:
            self._say(f"Compiling {compilation.data['dispatcher'].py_func.__name__} (first start only)", None)

    def on_end(self, compilation: event.Event) -> None:
        """One function more."""
        self._depth -= 1
        if self._is_first:
            self._done += is_ours(compilation)
            self._tell()
        elif not (self._depth or self._is_first):
            self.report("")

    def _begin_helper(self) -> None:
        if self._helper is None:
            self._helper = helper()
            threading.Thread(target=self._listen, args=(self._helper,), name="helper", daemon=True).start()

    def _listen(self, process: "subprocess.Popen[str]") -> None:
        """Until the helper ends, which it does alone, or as this process does."""
        assert process.stdout is not None
        for line in process.stdout:
            if line.strip() != READY:
                self._done += 1
            elif self._wanted == FIRST:
                self._ready.set()
        self._ready.set()
        process.wait()

    def _tell(self) -> None:
        done, what = min(self._done, self._wanted), "first scan" if self._wanted == FIRST else "stream"
        text = f"Compiling for the {what}: {done} of {self._wanted} functions (first start only)"
        self._share = done / self._wanted
        self._say(text, self._share)

    def _say(self, text: str, share: float | None) -> None:
        self.report(text, share)
        if sys.stderr.isatty():
            print(f"\r{text}", end="\n" if share in {None, 1.0} else "", file=sys.stderr, flush=True)
        elif share is None or not self._is_told:  # one line is enough of what goes on
            print(text, file=sys.stderr, flush=True)
        self._is_told = True


def is_ours(compilation: event.Event) -> bool:
    """Whether a function of the core was compiled, and not one of numba's own."""
    module: str = compilation.data["dispatcher"].py_func.__module__
    return module.startswith("slam_core.")


_compiler = _Compiler()


def helper() -> "subprocess.Popen[str]":
    """In a session of its own: an interrupt at the terminal is not for it. It ends when its input does."""
    command = [sys.executable, "-c", HELP.format(sys.path)]
    pipe, quiet = subprocess.PIPE, subprocess.DEVNULL
    return subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=quiet, start_new_session=True, text=True)


class _Counted(event.Listener):
    """A line of output for each function that the helper compiles."""

    def on_start(self, compilation: event.Event) -> None:
        """Nothing yet."""

    def on_end(self, compilation: event.Event) -> None:
        """It is done."""
        if is_ours(compilation):
            print(flush=True)


def _help() -> None:
    """What the helper does, for as long as the process lives that began it."""

    def watch() -> None:
        os.read(sys.stdin.fileno(), 1)  # until the other end is closed
        os._exit(1)

    threading.Thread(target=watch, name="watching who is helped", daemon=True).start()
    cast(Any, event.unregister)("numba:compile", _compiler)
    listen("numba:compile", _Counted())
    gc.set_threshold(10 * GARBAGE)
    motion = _first_motion()
    print(READY, flush=True)
    os.nice(POLITE)
    _second_scan(motion)
    load_everything()


END_NS = 2_000_000_000


def _first_map() -> None:
    """What the first scan needs but for the motion: it is placed and written."""
    config, scan = SlamConfig(), _scan(END_NS)
    placed = stabilise(scan, EgoMotion(config).poses, config.scan)
    mapper = Mapper(Pyramid(config.map), writes=True)
    mapper.update(placed, np.zeros(3), None, ACCEPTED, END_NS, config.map, unaided=False)


def _first_motion() -> EgoMotion:
    """The filter as it is aligned at rest, and its prediction."""
    motion = EgoMotion(SlamConfig())
    for measurement in _room(inertial=True):
        if not isinstance(measurement, LaserScan | Odometry | Height):
            motion.take(measurement)
    motion.awaits_filter(_scan(END_NS), begun=False)
    motion.poses(END_NS - 100_000_000, np.array([0, 50_000_000, 100_000_000]))
    motion.prior(END_NS)
    return motion


def _second_scan(motion: EgoMotion) -> None:
    """What the second scan needs but for its match, which the run compiles meanwhile."""
    motion.take(Height(END_NS, 0.0))
    motion.take(Odometry(END_NS, np.zeros(2), 0.0))
    motion.correct(END_NS, None, accepted=True)
    config = SlamConfig()
    _noise(_scan(END_NS))
    placed = stabilise(_scan(END_NS), EgoMotion(config).poses, config.scan)
    Pyramid(config.map).clear(placed.points, placed.laser, np.zeros(3), config.map)


def _noise(scan: LaserScan) -> None:
    """What measures the noise of ranges, and takes it out."""
    ranges, limits, noise = scan.ranges, (scan.range_min, scan.range_max), np.ones(BANDS)
    learn_noise(ranges, ranges, limits, noise.copy(), noise)
    smooth(ranges, directions(scan.angle_min, scan.angle_increment, len(ranges)), limits, noise, 0.1, 0.1)


def load_everything() -> None:
    """Load or compile every kernel: a few scans of a small made-up room through every branch."""
    for inertial in (True, False):
        _everything(inertial)
    _spare_collector()


def _spare_collector() -> None:
    """What is loaded by now stays: the garbage collector need not go through it again, which takes 0.1 s."""
    gc.freeze()
    gc.set_threshold(GARBAGE)


def _everything(inertial: bool) -> None:
    config = with_value(SlamConfig(), "map.size", 256)
    prior_map = None
    for method in ("hessian", "sampled"):
        pipeline = Pipeline(Settings(with_value(config, "matcher.covariance", method)), prior_map=prior_map)
        for measurement in _room(inertial):
            for ready in pipeline.admit(measurement):
                pipeline.step(ready)
        for ready in pipeline.flush():
            pipeline.step(ready)
        pipeline.slam.reset_pose(PlanarGaussian(np.zeros(3), np.eye(3)))  # as where it was found again
        pipeline.step(_scan(END_NS + 1))
        _noise(_scan(END_NS))
        placed = stabilise(_scan(END_NS), EgoMotion(config).poses, config.scan)
        placements = Placements()  # of a local map
        placements.add([np.zeros(3)], np.zeros(3))
        placements.judge(pipeline.slam.map, [KeptScan(placed, np.zeros(3), END_NS)], Usual(1.0, 0.0), config)
        inside = pipeline.slam.map.levels[0]
        costs(inside, np.zeros((1, 2), np.float32), np.zeros((1, 3)))
        foreground(np.zeros((1, 2), np.float32))
        confirmed(pipeline.slam.map, placed.points, np.zeros(3))
        match = coarse_to_fine(pipeline.slam.map, placed.points, np.zeros(3), config.matcher)
        loose = match._replace(weakest_share=0.0)  # as in a corridor
        best_along(pipeline.slam.map, placed.points, loose, PlanarGaussian(np.zeros(3), np.eye(3)))
        prior_map = PriorMap("the room", saved_levels(pipeline.slam.map))  # the second run seeks its place there


def _room(inertial: bool) -> list[Measurement]:
    """Two seconds at rest: a scan every 0.1 s, other data besides."""
    measurements: list[Measurement] = []
    for tick in range(201):
        stamp_ns = tick * 10_000_000
        if inertial:
            measurements.append(Imu(stamp_ns, np.zeros(3), np.array([0.0, 0.0, 9.80665])))
            measurements.append(Height(stamp_ns, 0.0))
            measurements.append(GroundDistance(stamp_ns, 0.5, np.zeros(3), np.array([0.0, 0.0, -1.0])))
        if tick % 10 == 0:
            measurements.append(Odometry(stamp_ns, np.zeros(2), 0.0))
            # The last one fits nowhere: it is searched for.
            measurements.append(_scan(stamp_ns, 1.0 if tick < 200 else 1.6))
    return measurements


def _scan(stamp_ns: int, share: float = 1.0) -> LaserScan:
    """In the middle of a room of 4 by 4 metres, or of a larger one."""
    angles = np.linspace(-np.pi, np.pi, 181)
    ranges = (2.0 / np.maximum(np.abs(np.cos(angles)), np.abs(np.sin(angles)))).astype(np.float32)
    ranges[:3] = np.inf
    return LaserScan(stamp_ns, share * ranges, -np.pi, float(angles[1] - angles[0]), 1e-5, 0.1, 30.0)
