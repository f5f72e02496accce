"""What a person states of devices that do not keep to the definition of their messages, put right."""

import math
from dataclasses import replace

import numpy as np

from hectorscope.inputs import SourceError, SourceOptions
from slam_core import geometry
from slam_core.measurements import FARTHEST_LASER, Attitude, Float64s, Imu, LaserScan, MagneticField, Transform

STANDARD_GRAVITY = 9.80665
ACCEL_UNITS = {"m/s2": 1.0, "g": STANDARD_GRAVITY, "mg": 1e-3 * STANDARD_GRAVITY}
GYRO_UNITS = {"rad/s": 1.0, "deg/s": math.pi / 180.0}
# From a clock that counts from its start to one that counts from 1970, and beyond.
LONGEST_DELAY_S = 4e9
# No sweep lasts longer: a number beyond it is in another unit.
LONGEST_SWEEP_S = 10.0


class Repairs:
    """Units, axes and delays of one recording or connection; SourceError for a value that cannot be meant."""

    def __init__(self, options: SourceOptions) -> None:
        self.imu_delay_ns = _delay_ns("imu-delay", options.imu_delay)
        self.scan_delay_ns = _delay_ns("scan-delay", options.scan_delay)
        self.laser_pose = _placed(options.laser_pose) if options.laser_pose else None
        self._mirrored = options.scan_mirrored is True
        self._sweep_s = _seconds("scan-sweep", options.scan_sweep, LONGEST_SWEEP_S)
        sign = {vector: -1.0 if options.imu_inverted == vector else 1.0 for vector in ("accel", "gyro")}
        self._accel = sign["accel"] * ACCEL_UNITS[options.imu_accel_unit or "m/s2"]
        self._gyro = sign["gyro"] * GYRO_UNITS[options.imu_gyro_unit or "rad/s"]
        self._turned = _turned("imu-rotation", options.imu_rotation or (0.0, 0.0, 0.0))
        self._plain = self._accel == self._gyro == self._turned[0] == 1.0

    def imu(self, imu: Imu) -> Imu:
        """Inertial data in SI units, about the axes of the base."""
        if self._plain:
            return imu
        both = np.stack([self._gyro * imu.angular_velocity, self._accel * imu.linear_acceleration])
        rates, forces = geometry.rotate(self._turned, both)
        return Imu(imu.stamp_ns, rates, forces)

    def attitude(self, attitude: Attitude) -> Attitude:
        """The orientation of the base by an IMU that sits on it turned."""
        rotation = geometry.multiply(attitude.rotation, geometry.conjugate(self._turned))
        return Attitude(attitude.stamp_ns, rotation)

    def magnetic(self, magnetic: MagneticField) -> MagneticField:
        """The field by the magnetometer of an IMU that sits turned."""
        if self._turned[0] == 1.0:
            return magnetic
        return replace(magnetic, field=geometry.rotate(self._turned, magnetic.field))

    def sweep_ns(self, stated_ns: int) -> int:
        """From the first beam of a scan to its last, if its message states so much."""
        return stated_ns if self._sweep_s is None else round(abs(self._sweep_s) * 1e9)

    def scan(self, scan: LaserScan) -> LaserScan:
        """A scan with its beams the right way round, at their times."""
        if self._sweep_s is not None:
            scan = with_sweep(scan, self._sweep_s)
        if not self._mirrored:
            return scan
        return replace(scan, angle_min=-scan.angle_min, angle_increment=-scan.angle_increment)


def with_sweep(scan: LaserScan, seconds: float) -> LaserScan:
    """The scan with a sweep of so many seconds, from its stamp on; negative: its last beam is the first."""
    n = len(scan.ranges)
    timed = replace(scan, time_increment=abs(seconds) / max(n - 1, 1))
    if seconds >= 0.0:
        return timed
    last = scan.angle_min + (n - 1) * scan.angle_increment
    return replace(timed, ranges=scan.ranges[::-1].copy(), angle_min=last, angle_increment=-scan.angle_increment)


def _placed(pose: tuple[float, ...]) -> Transform:
    translation = np.array(pose[:3])
    if not np.abs(translation).max() <= FARTHEST_LASER:  # so, too, where one is no number
        raise SourceError(f"--laser-pose is {_words(pose)}: give metres up to {FARTHEST_LASER:g}, then radians")
    return Transform(translation, _turned("laser-pose", pose[3:]))


def _turned(flag: str, angles: tuple[float, ...]) -> Float64s:
    if not all(abs(angle) <= 2.0 * math.pi for angle in angles):  # beyond, they are degrees
        raise SourceError(f"--{flag} turns by {_words(angles)}: give radians, from -2 pi to 2 pi")
    return geometry.from_euler(*angles)


def _words(values: tuple[float, ...]) -> str:
    return " ".join(f"{value:g}" for value in values)


def _seconds(flag: str, seconds: float | None, longest: float) -> float | None:
    if seconds is not None and not abs(seconds) <= longest:
        raise SourceError(f"--{flag} is {seconds:g} s: give -{longest:g} to {longest:g}")
    return seconds


def _delay_ns(flag: str, seconds: float | None) -> int:
    return round((_seconds(flag, seconds, LONGEST_DELAY_S) or 0.0) * 1e9)
