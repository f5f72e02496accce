"""How well the navigation filter holds attitude and height: simulated inertial data, barometer and noisy matches.

    python -m benchmarks.navigation [--omegas 0.005 0.01 0.02] [--seeds 1 2 3] [--set navigation.accel_noise=0.05]

The match is the truth in the plane with noise, 40 times a second, and claims a covariance R that is too small, as
scan matchers do. Prints root mean squares per scene over the seeds: roll and pitch in degrees (worst of both),
height in metres, heading in degrees, position in the plane in metres, the errors of tilt and height over their own
sigmas, velocity in m/s, and gyro biases in degrees/s (worst axis).
"""

import argparse
from itertools import product
from typing import Any

import numpy as np

from hectorscope.simulation import SceneOptions, Simulation
from hectorscope.simulation.options import ScenarioName
from hectorscope.simulation.sensors import START_NS, heights, inertial
from slam_core import geometry
from slam_core.config import SlamConfig, leaves, with_value
from slam_core.measurements import Float64s, Imu
from slam_core.navigation.filter import NavigationFilter

SCENES = ("arena", "littoral", "handheld", "rooms")
SCAN_NS = 25_000_000
SWEEP_NS = 18_750_000
WARM_UP_NS = 2_000_000_000
NOISE = np.array([0.01, 0.01, np.radians(0.1)])
CLAIMED = np.array([0.005, 0.005, np.radians(0.1)])


def drive(
    scene: ScenarioName, seed: int, config: SlamConfig, correlation: float = 0.0, barometer: bool = True
) -> Float64s:
    """(n, 14) at the scans: errors of roll, pitch, heading, x, y, z; sigmas of roll, z; errors of v, gyros."""
    simulation = Simulation(scene, SceneOptions(seed=seed))
    motion, rng = simulation.scene.motion, np.random.default_rng([seed, 9])
    estimator = NavigationFilter(config.navigation)
    samples = sorted(
        [*inertial(motion, simulation.options), *(heights(motion, simulation.options) if barometer else ())],
        key=lambda arrival: arrival[0],
    )
    errors, scan_ns, noise = [], 0, NOISE * rng.normal(size=3)
    bias = _gyro_bias([sample for _, sample in samples if isinstance(sample, Imu)], simulation)
    for _, sample in samples:
        if isinstance(sample, Imu):
            estimator.predict(sample)
            scan_ns = scan_ns or sample.stamp_ns
        else:
            estimator.update_height(sample.stamp_ns, sample.height)
        while sample.stamp_ns >= scan_ns + SWEEP_NS:
            middle = scan_ns + SWEEP_NS // 2
            scan_ns += SCAN_NS
            noise = correlation * noise + np.sqrt(1 - correlation**2) * NOISE * rng.normal(size=3)
            if estimator.ready:
                truth = simulation.truth_at(middle)
                xi = geometry.planar(truth) + noise
                omega, widen = config.fusion.omega, config.fusion.widen_vertical
                R = np.diag(CLAIMED**2)
                state = estimator.fuse_planar(middle, xi, R, omega, widen_vertical=widen)
                velocity = motion.at(np.array([(middle - START_NS) * 1e-9]), 1)[0, :3]
                drift = (*(state.velocity - velocity), *(state.gyro_bias - bias))
                errors.append((middle, *_errors(state, truth), *drift))
    table = np.array(errors)
    late: Float64s = table[table[:, 0] > table[0, 0] + WARM_UP_NS, 1:]
    return late


def _gyro_bias(imus: list[Imu], simulation: Simulation) -> Float64s:
    """(3,) what the gyros read too much on the mean."""
    t = np.array([(imu.stamp_ns - START_NS) * 1e-9 for imu in imus])
    read = np.array([imu.angular_velocity for imu in imus])
    bias: Float64s = np.mean(read - simulation.scene.motion.body_rates(t), axis=0)
    return bias


def _errors(state: Any, truth: Any) -> list[float]:
    q, p = state.T_map_base.rotation, state.T_map_base.translation
    roll, pitch, _ = geometry.to_euler(q)
    true_roll, true_pitch, _ = geometry.to_euler(truth.rotation)
    heading = geometry.wrap(geometry.heading(q) - geometry.heading(truth.rotation))
    sigma = np.sqrt(np.diag(state.covariance))
    return [roll - true_roll, pitch - true_pitch, heading, *(p - truth.translation), sigma[0], sigma[5]]


def summary(errors: Float64s) -> dict[str, float]:
    """Root mean squares of `drive`."""
    rms = np.sqrt(np.mean(errors**2, axis=0))
    return {
        "roll/pitch": float(np.degrees(max(rms[0], rms[1]))),
        "height": float(rms[5]),
        "heading": float(np.degrees(rms[2])),
        "plane": float(np.hypot(rms[3], rms[4])),
        "tilt/sigma": float(np.hypot(rms[0], rms[1]) / rms[6] / np.sqrt(2)),
        "height/sigma": float(rms[5] / rms[7]),
        "velocity": float(np.linalg.norm(rms[8:11])),
        "gyro bias": float(np.degrees(max(rms[11:14]))),
    }


def main() -> None:
    """Print one table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--scenes", nargs="+", default=SCENES)
    parser.add_argument("--seeds", nargs="+", type=int, default=[1, 2, 3])
    parser.add_argument("--omegas", nargs="+", type=float, default=[SlamConfig().fusion.omega])
    parser.add_argument("--correlation", type=float, default=0.0, help="of the error of one match with the next")
    parser.add_argument("--no-barometer", action="store_true")
    parser.add_argument("--set", nargs="+", default=[], metavar="NAME=VALUE", help="settings, as navigation.X=1.0")
    options = parser.parse_args()
    config = SlamConfig()
    types = {leaf.name: leaf.type for leaf in leaves(config)}
    for name, value in (pair.split("=") for pair in options.set):
        config = with_value(config, name, types[name](value))
    print(
        f"{'omega':>6} {'scene':>9} | roll/pitch deg | height m | heading deg | plane m | tilt/s | height/s | "
        "velocity m/s | gyro deg/s"
    )
    for omega, scene in product(options.omegas, options.scenes):
        chosen = with_value(config, "fusion.omega", omega)
        runs = [drive(scene, s, chosen, options.correlation, not options.no_barometer) for s in options.seeds]
        s = summary(np.concatenate(runs))
        print(
            f"{omega:6.3f} {scene:>9} | {s['roll/pitch']:14.2f} | {s['height']:8.3f} | {s['heading']:11.3f} | "
            f"{s['plane']:7.4f} | {s['tilt/sigma']:6.2f} | {s['height/sigma']:8.2f} | {s['velocity']:12.3f} | "
            f"{s['gyro bias']:10.3f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
