"""Whether the sensors are what their messages promise, judged by the data, and which options repair it.

The norm of the accelerometer gives its unit, its direction which way up it sits. The turn about that direction,
compared with the turn that the scans show, gives the unit of the gyroscope, the handedness of scan and IMU, and
the delay. Scans of a robot that turns show when their beams are measured. Nothing is
reported where the data does not show it, and what a person has stated is not checked.
"""

import math
from collections.abc import Iterator, Sequence

from hectorscope.checks.beam_times import BeamTimes
from hectorscope.checks.contradictions import Agreement, Gravity
from hectorscope.checks.sensor_statistics import Measures
from hectorscope.inputs import Finding, OptionValue, SourceOptions, flags
from hectorscope.ros.repairs import ACCEL_UNITS, STANDARD_GRAVITY
from slam_core import geometry
from slam_core.navigation.initial_alignment import upright

UNIT_BAND = 2.5  # a unit is recognised where it explains a value within this factor
STEADY = 0.9  # gravity that comes from all sides is that of an IMU in somebody's hand
LEANING = 0.5  # cosine: no robot drives about with a steeper lean than this
LATE_S = 0.06
EXPLAINED = 0.25  # a delay explains this share of a disagreement at least; swaying feigns smaller ones
UNIT_NAMES = {"m/s2": "m/s²", "g": "g", "mg": "milli-g"}


def findings(measures: Measures, options: SourceOptions) -> list[Finding]:
    """What contradicts the messages; nothing about what `options` state."""
    measured, turn = measures.gravity, measures.turn
    return [
        *(_accel_unit(measured) if measured and options.imu_accel_unit is None else ()),
        *(_gyro_unit(measures) if options.imu_gyro_unit is None else ()),
        *_axes(measures, options),
        *(_delay(turn, options) if turn else ()),
        *(_beam_times(measures.times) if measures.times and options.scan_sweep is None else ()),
    ]


def remedy(found: Sequence[Finding]) -> str:
    """The flags that repair all of it."""
    return flags(repairing_options(found))


def repairing_options(found: Sequence[Finding]) -> dict[str, OptionValue]:
    """The options that repair all of it."""
    return {name: value for finding in found for name, value in finding.options.items()}


def _accel_unit(measured: Gravity) -> Iterator[Finding]:
    fits = (name for name, unit in ACCEL_UNITS.items() if _near(measured.norm * unit, STANDARD_GRAVITY))
    name = next(fits, None)
    fact = f"the accelerometer shows gravity as {measured.norm:.4g}"
    if name is None:
        yield Finding(f"{fact}, which no unit explains (9.81 m/s², 1 g, 1000 milli-g)", {"imu_topic": "none"})
    elif name != "m/s2":
        yield Finding(f"{fact}, so in {UNIT_NAMES[name]} and not in m/s²", {"imu_accel_unit": name})


def _gyro_unit(measures: Measures) -> Iterator[Finding]:
    for agreement, reference in ((measures.turn, "the scans show"), (measures.tilt, "gravity shows")):
        if agreement and _near(agreement.ratio, math.degrees(1.0)):
            fact = f"the gyroscope turns {agreement.ratio:.0f} times as far as {reference}, so in degrees a second"
            yield Finding(fact, {"imu_gyro_unit": "deg/s"})
            return


def _axes(measures: Measures, options: SourceOptions) -> Iterator[Finding]:
    """Three that should agree: where gravity is, how the gyroscope turns, how the scans turn."""
    sign = _sign(measures) if options.scan_mirrored is None and options.imu_inverted is None else None
    if sign:
        yield sign
    if options.imu_rotation is None and (sign is None or sign.options != {"imu_inverted": "accel"}):
        yield from _mounting(measures)


def _sign(measures: Measures) -> Finding | None:
    """Which of the three has the wrong sign, by whom the other two side with."""
    turn, tilt, wheels = measures.turn, measures.tilt, measures.wheels
    opposed = turn is not None and turn.correlation < 0.0
    if tilt and tilt.correlation < 0.0:
        fact = f"the gyroscope turns against the way gravity moves ({_score(tilt)})"
        return Finding(fact, {"imu_inverted": "gyro"})
    if turn and opposed and measures.gravity and _hangs(measures.gravity):
        fact = f"gravity points down while the gyroscope turns against the scans ({_score(turn)})"
        return Finding(f"{fact}, so accelerations have the wrong sign", {"imu_inverted": "accel"})
    if turn and opposed:
        fact = f"scans and gyroscope turn opposite ways ({_score(turn)})"
        return Finding(f"{fact}, so the beams run the wrong way round", {"scan_mirrored": True})
    if wheels and wheels.correlation < 0.0:
        fact = f"scans and odometry turn opposite ways ({_score(wheels)})"
        return Finding(fact, {"odometry_topic": "none"} if turn else {"scan_mirrored": True})
    return None


def _mounting(measures: Measures) -> Iterator[Finding]:
    """Sure only once the robot has turned: until then somebody may not have set it up yet."""
    measured = measures.gravity
    if measured is None or measured.steadiness < STEADY or measured.up[2] > LEANING:
        return
    roll, pitch, _ = geometry.to_euler(upright(measured.up))
    toward = ", ".join(f"{part:.2f}" for part in measured.up)
    how = "upside down" if _hangs(measured) else "on its side"
    yield Finding(
        f"up is ({toward}) in the axes of the base, so the IMU is mounted {how}",
        {"imu_rotation": (float(f"{_snapped(roll):.5g}"), float(f"{_snapped(pitch):.5g}"), 0.0)},
        grave=measures.turn is not None,
    )


def _delay(turn: Agreement, options: SourceOptions) -> Iterator[Finding]:
    if abs(turn.lag) < LATE_S or turn.explained < EXPLAINED:
        return
    option, name, known_s = (
        ("scan_delay", "the scans are", options.scan_delay)
        if turn.lag > 0.0
        else ("imu_delay", "the inertial data is", options.imu_delay)
    )
    total_s = (known_s or 0.0) + abs(turn.lag)
    yield Finding(f"{name} stamped {abs(turn.lag):.2f} s late", {option: round(total_s, 2)}, grave=False)


def _beam_times(times: BeamTimes) -> Iterator[Finding]:
    if times.are_wrong:
        fact, given = "the scans fit better with the last beam as the first", "as stated"
        if not times.stated_s:
            fact = f"no message times the beams, and the scans fit better as sweeps of {times.sweep_s:.2g} s"
            given = "taken at once"
        residuals = f"mean residual in turns {times.residual:.3f}, {given} {times.other:.3f}"
        yield Finding(f"{fact} ({residuals})", {"scan_sweep": round(times.sweep_s, 4)}, grave=False)


def _hangs(measured: Gravity) -> bool:
    return measured.steadiness >= STEADY and bool(measured.up[2] < -LEANING)


def _near(value: float, expected: float) -> bool:
    return expected / UNIT_BAND < value < expected * UNIT_BAND


def _snapped(angle: float) -> float:
    """Mounts are square mostly: what is within 15 degrees of a right angle is meant to be one."""
    square = round(angle / (math.pi / 2)) * math.pi / 2
    if abs(angle - square) > math.radians(15.0):
        return angle
    return math.pi if abs(square) == math.pi else square


def _score(agreement: Agreement) -> str:
    return f"correlation {agreement.correlation:.2f}"
