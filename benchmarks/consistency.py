"""How honest, accurate and fast the navigation filter is, over many drives; writes docs/navigation-filter.md.

    python -m benchmarks.consistency [--seeds 20]

The inertial noise is exactly that of the configuration, so that the truth should lie where the covariance says.
Matches and heights have the noise of their covariance; the errors of matches are independent, or each is nearly
that of the one before, as a map makes them. build/consistency.csv holds what a plot needs.
"""

import argparse
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import get_args

import numpy as np

from benchmarks import navigation
from benchmarks.kernels import microseconds
from benchmarks.tables import table
from hectorscope.run.warmup import load_everything
from hectorscope.simulation.motion import GRAVITY, Motion
from slam_core import geometry
from slam_core.config import FusionConfig, FusionMethod, NavigationConfig, PlatformConfig, SlamConfig
from slam_core.kernels.imu_propagation import COLUMNS
from slam_core.kernels.navigation import STATES
from slam_core.measurements import Float64s, Imu
from slam_core.navigation.chi_square import quantile
from slam_core.navigation.corrections import BodyVelocity, Correction, HeightAid, PlanarPose
from slam_core.navigation.filter import NavigationFilter
from slam_core.navigation.imu_buffer import ImuBuffer
from slam_core.navigation.strapdown import Strapdown
from slam_core.results import NavigationState
from tests.conftest import ROOT

RATE, SECONDS, STILL, SETTLED = 200, 30.0, 1.0, 20.0
SCAN_EVERY, HEIGHT_EVERY, LOOK_EVERY = 5, 20, 40  # samples
MATCH_SIGMA = np.array([0.01, 0.01, math.radians(0.1)])
HEIGHT_SIGMA = 0.15
OMEGA, WIDEN = FusionConfig().omega, FusionConfig().widen_vertical
CORRELATION = 0.95  # of the error of a match with that of the one before, 25 ms earlier
# Nothing but the measurements: pseudo measurements are no part of the model that is simulated.
CONFIG = NavigationConfig(
    height_sigma=HEIGHT_SIGMA, tilt_threshold=1.0, zero_velocity_threshold=20.0, height_threshold=100.0
)
Runs = dict[tuple[FusionMethod, float], list["Drive"]]
AT_20 = slice(720, 760)  # of the rows of `navigation.drive`: 40 a second, from 2 s on
ALL, PLANAR = list(range(15)), [2, 3, 4]
METHODS: tuple[FusionMethod, ...] = get_args(FusionMethod)
OUT, PLOT = ROOT / "docs" / "navigation-filter.md", ROOT / "build" / "consistency.csv"


def course(t: Float64s) -> Float64s:
    """Stands still, then walks a figure of eight up and down, swaying."""
    s = np.maximum(t - STILL, 0.0)
    grown = np.clip(s / 2.0, 0.0, 1.0) ** 2 * (3.0 - 2.0 * np.clip(s / 2.0, 0.0, 1.0))
    x, y = 4.0 * np.sin(0.25 * s), 2.0 * np.sin(0.5 * s)
    z = 0.5 * (1.0 - np.cos(0.3 * s))
    roll, pitch = 0.15 * grown * np.sin(2.0 * s), 0.1 * grown * np.sin(1.3 * s)
    return np.column_stack((x, y, z, roll, pitch, 0.8 * grown * np.sin(0.4 * s)))


MOTION = Motion.through(course, SECONDS)


@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """Rows at instants: time, NEES of the state (15), of the planar pose (3), errors of the state (15)."""

    rows: Float64s

    @property
    def late(self) -> Float64s:
        """The rows once it has settled."""
        return self.rows[self.rows[:, 0] >= SETTLED]


def samples(seed: int, config: NavigationConfig) -> tuple[list[Imu], Float64s]:
    """What the sensors say a `RATE` times a second, and their biases (n, 6)."""
    rng = np.random.default_rng([seed, 0])
    t = np.arange(round(SECONDS * RATE)) / RATE
    walk = np.repeat([config.gyro_bias_walk, config.accel_bias_walk], 3) / math.sqrt(RATE)
    start = rng.normal(size=6) * np.repeat([0.005, config.accel_bias_sigma], 3)
    biases = start + np.cumsum(rng.normal(size=(len(t), 6)) * walk, axis=0)
    noise = rng.normal(size=(len(t), 6)) * np.repeat([config.gyro_noise, config.accel_noise], 3) * math.sqrt(RATE)
    values = np.hstack((MOTION.body_rates(t), MOTION.specific_force(t))) + biases + noise
    return [Imu(round(k * 1e9 / RATE), v[:3], v[3:]) for k, v in enumerate(values)], biases


def drive(seed: int, method: FusionMethod, correlation: float) -> Drive:
    """One drive by one method of fusion."""
    rng, estimator = np.random.default_rng([seed, 1]), NavigationFilter(CONFIG)
    imus, biases = samples(seed, CONFIG)
    rows, noise = [], MATCH_SIGMA * rng.normal(size=3)
    for k, imu in enumerate(imus):
        estimator.predict(imu)
        if k % SCAN_EVERY == 0:
            noise = correlation * noise + math.sqrt(1 - correlation**2) * MATCH_SIGMA * rng.normal(size=3)
        if not estimator.ready:
            continue
        truth = MOTION.transform(k / RATE)
        if k % SCAN_EVERY == 0:
            xi, R = geometry.planar(truth) + noise, np.diag(MATCH_SIGMA**2)
            estimator.fuse_planar(imu.stamp_ns, xi, R, OMEGA, method, widen_vertical=WIDEN)
        if k % HEIGHT_EVERY == 0:
            estimator.update_height(imu.stamp_ns, truth.translation[2] + HEIGHT_SIGMA * rng.normal())
        if k % LOOK_EVERY == 0:
            state = estimator.at(imu.stamp_ns)
            off = error(state, k, biases)
            rows.append([k / RATE, *(_nees(off, state.covariance, part) for part in (ALL, PLANAR)), *off])
    return Drive(np.array(rows))


def error(state: NavigationState, k: int, biases: Float64s) -> Float64s:
    """Truth minus estimate in the fifteen errors of the filter."""
    t = np.array([k / RATE])
    truth, velocity = MOTION.transform(k / RATE), MOTION.at(t, 1)[0, :3]
    turn = geometry.multiply(truth.rotation, geometry.conjugate(state.T_map_base.rotation))
    bias = biases[k] - np.concatenate((state.gyro_bias, state.accel_bias))
    where = truth.translation - state.T_map_base.translation
    return np.concatenate((geometry.to_rotation_vector(turn), where, velocity - state.velocity, bias))


def _nees(off: Float64s, P: Float64s, part: list[int]) -> float:
    """The normalised estimation error squared of some of the errors."""
    return float(off[part] @ np.linalg.solve(P[np.ix_(part, part)], off[part]))


@dataclass(frozen=True, slots=True)
class Verdict:
    """Mean NEES over seeds and instants, by its dimension, and the 95 % bounds of the mean over the seeds."""

    nees: float
    bounds: tuple[float, float]

    @property
    def word(self) -> str:
        """The verdict on the filter."""
        low, high = self.bounds
        return "over-confident" if self.nees > high else "conservative" if self.nees < low else "consistent"


def judge(drives: list[Drive], column: int, dimension: int) -> Verdict:
    """The instants of a drive are far from independent: the bounds are those of one instant."""
    mean = float(np.mean([each.late[:, column] for each in drives])) / dimension
    n = dimension * len(drives)
    return Verdict(mean, (quantile(0.975, n) / n, quantile(0.025, n) / n))


def consistency(runs: Runs) -> str:
    """A row for each method and kind of error."""
    head = (
        "method",
        "errors of matches",
        "NEES of the state / 15",
        "NEES of the pose / 3",
        "the pose is",
        "position, rms",
    )
    return table(head, (_row(*key, drives) for key, drives in runs.items()))


def _row(method: str, correlation: float, drives: list[Drive]) -> Iterator[str]:
    state, pose = judge(drives, 1, 15), judge(drives, 2, 3)
    yield method
    yield f"correlated, {correlation:g}" if correlation else "independent"
    for verdict in (state, pose):
        yield f"{verdict.nees:.2f} ({verdict.bounds[0]:.2f} to {verdict.bounds[1]:.2f})"
    yield pose.word
    off = np.concatenate([each.late[:, 6:8] for each in drives])
    yield f"{100 * math.sqrt(float(np.mean(np.sum(off**2, axis=1)))):.2f} cm"


def accuracy(seeds: list[int]) -> str:
    """What the filter reaches with its defaults on `arena`, with consumer sensors, and what it must reach."""
    runs = [navigation.drive("arena", seed, SlamConfig()) for seed in seeds]
    rms = navigation.summary(np.concatenate(runs))
    found = np.concatenate([run[AT_20] for run in runs])[:, 11:14]
    rows = (
        ("roll and pitch, rms of the worse", rms["roll/pitch"], 0.5, "°"),
        ("height, rms", rms["height"], 0.15, "m"),
        ("velocity, rms", rms["velocity"], 0.05, "m/s"),
        ("gyro biases after 20 s, rms", math.degrees(math.sqrt(float(np.mean(found**2)))), 0.05, "°/s"),
    )
    return table(
        ("figure", "found", "goal", "held"),
        ((name, f"{v:.3f} {u}", f"{goal:g} {u}", "yes" if v <= goal else "no") for name, v, goal, u in rows),
    )


def speed(seconds: int = 3600) -> str:
    """What a prediction and an update cost, and so many seconds of samples with matches."""
    model, still = Strapdown(NavigationConfig(), PlatformConfig()), np.zeros(COLUMNS)
    still[5] = GRAVITY
    x, P = np.zeros(STATES), np.diag(np.repeat([0.01, 0.05, 0.1, 0.005, 0.1], 3) ** 2)
    x[0], x[18] = 1.0, GRAVITY
    recorded = ImuBuffer()
    for k in range(2):
        recorded.append(k * 5_000_000, still)
    R = np.diag(MATCH_SIGMA**2)
    corrections: dict[str, Correction] = {f"match, {m}": PlanarPose(np.zeros(3), R, 0.02, m) for m in METHODS}
    corrections |= {"height": HeightAid(0.0, 0.2, 5.0), "wheels": BodyVelocity(np.zeros(2), 0.05)}
    took = microseconds(lambda: model.predict(x, P, 0, 5_000_000, recorded))
    rows = [("prediction with covariance", f"{took:.1f} us", "8 us")]
    for name, correction in corrections.items():
        rows.append((f"update by {name}", f"{microseconds(partial(correction.update, x, P)):.1f} us", "12 us"))
    took, least = hour(seconds)
    whole = f"{seconds} s at {RATE} Hz, 10 matches a second"
    rows += [(whole, f"{took:.0f} s", "60 s"), ("least eigenvalue of P in that time", f"{least:.0e}", "> 0")]
    return table(("part", "found", "goal"), rows)


def hour(seconds: int = 3600) -> tuple[float, float]:
    """Seconds on the wall for so long at rest with noise, and the least eigenvalue of P, once a second."""
    rng, estimator, least = np.random.default_rng(1), NavigationFilter(NavigationConfig()), math.inf
    noise = rng.normal(size=(RATE, 6)) * np.repeat([0.005, 0.03], 3)
    begin = time.perf_counter()
    for second in range(seconds):
        for k in range(RATE):
            at_ns = second * 10**9 + k * 10**9 // RATE
            estimator.predict(Imu(at_ns, noise[k, :3], noise[k, 3:] + (0.0, 0.0, GRAVITY)))
            if k % 20 == 19 and estimator.ready:
                estimator.correct(at_ns - 5_000_000, PlanarPose(np.zeros(3), np.diag(MATCH_SIGMA**2), 0.02))
        if estimator.ready:
            least = min(least, float(np.linalg.eigvalsh(estimator.state.covariance)[0]))
    return time.perf_counter() - begin, least


def write_plot(runs: Runs) -> None:
    """NEES over time, the mean over the seeds: method, correlation, seconds, state / 15, pose / 3."""
    lines = ["method,correlation,time_s,nees_state,nees_pose\n"]
    for (method, correlation), drives in runs.items():
        means = np.mean([each.rows[:, :3] for each in drives], axis=0)
        lines += [f"{method},{correlation:g},{t:.2f},{s / 15:.4f},{p / 3:.4f}\n" for t, s, p in means.tolist()]
    PLOT.parent.mkdir(exist_ok=True)
    PLOT.write_text("".join(lines), encoding="utf-8")


def main() -> None:
    """Run everything and write the document."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--seeds", type=int, default=20)
    seeds = list(range(1, parser.parse_args().seeds + 1))
    load_everything()
    quick = speed()
    runs: Runs = {}
    for method, correlation in product(METHODS, (0.0, CORRELATION)):
        runs[method, correlation] = [drive(seed, method, correlation) for seed in seeds]
        print(method, correlation, flush=True)
    write_plot(runs)
    text = TEXT.format(seeds=len(seeds), consistency=consistency(runs), accuracy=accuracy(seeds[:5]), speed=quick)
    OUT.write_text(text, encoding="utf-8")


TEXT = f"""# The navigation filter, measured

Written by `python -m benchmarks.consistency`; do not edit. `build/consistency.csv` holds the curves over time.

## Honesty

{{seeds}} drives of {SECONDS:.0f} s along one course, from second {SETTLED:.0f} on, with sensors whose noise is
that of the configuration. NEES is the squared error in units of the covariance, by its dimension: 1 is
honest; in brackets what chance allows in 95 % of the cases. Matches come 40 times a second with the noise that
their covariance states; their errors are independent, or each is that of the one before to {CORRELATION:.0%}, as
when a map that was drawn from the pose is matched again. The Kalman update is right about the first and
over-confident about the second; covariance intersection pays for the second with caution in the first. Omega is
{OMEGA:g} where it is fixed. Height, vertical velocity and bias are not widened by it (`fusion.widen_vertical`):
no match knows of them, and widened they followed every error of the barometer.

{{consistency}}
## Accuracy

`arena` with the default settings, a consumer IMU and a barometer, over five seeds; matches good to 1 cm and 0.1°.

{{accuracy}}
## Speed

Medians of single calls.

{{speed}}"""


if __name__ == "__main__":
    main()
