"""Decoded ROS messages (rosbags objects of either generation) to measurements in SI units and REP-103 axes.

The functions are pure. A message that cannot be used raises `BadMessage` with the reason a person should read.
"""

import math
from typing import Any

import numpy as np

from hectorscope.inputs import Stamped
from slam_core import geometry
from slam_core.measurements import (
    FARTHEST_LASER,
    PLAUSIBLE,
    Attitude,
    Float64s,
    Imu,
    LaserScan,
    Odometry,
    Transform,
    TruthPose,
)

# A sweep of more than two turns is a mistake in the angles.
MAX_SWEEP_RAD = 4.0 * math.pi
# Sweeps last seconds at most; a longer one is a mistake in time_increment.
MAX_SWEEP_S = 10.0
# Zero stands for "no return" on many devices that announce range_min = 0.
SHORTEST_RANGE = 1e-3
# The mount of a distance sensor whose recording has no tf.
LOOKING_DOWN = Transform(rotation=geometry.from_euler(0.0, math.pi / 2, 0.0))


class BadMessage(Exception):
    """One message that is left out; the text is the reason."""


def message_type(message: Any) -> str:
    """The ROS 2 style name of a message's type."""
    name: str = message.__msgtype__
    return name


def stamp_ns(message: Any, receive_ns: int) -> int:
    """The message's own time; the time of receipt where it has none or leaves it at zero."""
    header = getattr(message, "header", None)
    if header is None:
        return receive_ns
    stamp = header.stamp
    own_ns: int = stamp.sec * 1_000_000_000 + stamp.nanosec
    return own_ns or receive_ns


def frame_id(message: Any) -> str:
    """The frame of a stamped message, without the leading slash of old tf."""
    name: str = message.header.frame_id
    return name.strip("/")


def stamped(topic: str, message: Any, log_ns: int) -> Stamped:
    """A message by its times; a scan with its ranges as they are."""
    header = getattr(message, "header", None)
    if header is None:
        return Stamped(topic, log_ns)
    own = stamp_ns(message, 0) or None
    ranges = getattr(message, "ranges", None)
    if ranges is None:
        return Stamped(topic, log_ns, own, frame_id(message))
    limits = float(message.range_min), float(message.range_max)
    return Stamped(topic, log_ns, own, frame_id(message), max(0, sweep_ns(message)), np.asarray(ranges), limits)


def laser_scan(message: Any, time_ns: int, T_base_laser: Transform) -> LaserScan:
    """sensor_msgs/LaserScan; the stamp is the first ray's. Ranges keep the values of REP-117."""
    increment, n = float(message.angle_increment), len(message.ranges)
    if n == 0:
        raise BadMessage("scan without beams")
    if not (math.isfinite(message.angle_min) and math.isfinite(increment)):
        raise BadMessage("scan whose angle_min or angle_increment is not a number")
    if increment == 0.0:
        raise BadMessage("scan with an angle_increment of 0")
    if abs(increment) * (n - 1) > MAX_SWEEP_RAD:
        raise BadMessage("scan over more than two turns: its angle_increment cannot be right")
    ranges = np.array(message.ranges, np.float32)
    if math.isnan(ranges[0]) and np.isnan(ranges).all():
        raise BadMessage("scan with nothing but NaN ranges")
    return LaserScan(
        time_ns,
        ranges,
        float(message.angle_min),
        increment,
        _time_increment(message, n),
        max(_finite(message.range_min, 0.0), SHORTEST_RANGE),
        _range_max(message),
        T_base_laser,
    )


def sweep_ns(message: Any) -> int:
    """From the first ray of a sensor_msgs/LaserScan to its last."""
    n = len(message.ranges)
    return round(max(n - 1, 0) * _time_increment(message, n) * 1e9)


def imu(message: Any, time_ns: int, rotation: Float64s) -> Imu:
    """sensor_msgs/Imu turned into base axes; rotation (4,) is that of T_base_imu. The lever arm is left out."""
    if message.angular_velocity_covariance[0] == -1.0 or message.linear_acceleration_covariance[0] == -1.0:
        raise BadMessage("IMU message that declares its rates or accelerations absent")
    omega, acceleration = message.angular_velocity, message.linear_acceleration
    rates = finite_vector("IMU message", omega.x, omega.y, omega.z)
    forces = finite_vector("IMU message", acceleration.x, acceleration.y, acceleration.z)
    if rotation[0] != 1.0:
        rates, forces = geometry.rotate(rotation, np.stack([rates, forces]))
    return Imu(time_ns, rates, forces)


def imu_attitude(message: Any, time_ns: int, rotation: Float64s) -> Attitude:
    """The orientation in a sensor_msgs/Imu, as that of the base; rotation (4,) is that of T_base_imu."""
    if message.orientation_covariance[0] == -1.0:
        raise BadMessage("IMU message that declares its orientation absent")
    world_imu = quaternion("IMU message", message.orientation)
    return Attitude(time_ns, geometry.multiply(world_imu, geometry.conjugate(rotation)))


def odometry(message: Any, time_ns: int) -> Odometry:
    """The twist of a nav_msgs/Odometry, which is in the frame of the base."""
    twist = message.twist.twist
    forward, left, turn = finite_vector("odometry", twist.linear.x, twist.linear.y, twist.angular.z)
    return Odometry(time_ns, np.array([forward, left]), float(turn))


def pressure_altitude(message: Any) -> float:
    """International barometric formula: metres over the level of 1013.25 hPa of a sensor_msgs/FluidPressure."""
    value = float(message.fluid_pressure)
    if not (math.isfinite(value) and value > 0.0):
        raise BadMessage("pressure that is no positive number")
    return 44330.77 * (1.0 - math.pow(value / 101325.0, 0.1902632))


def point_height(message: Any) -> float:
    """The z of a geometry_msgs/PointStamped."""
    return float(finite_vector("point", message.point.x, message.point.y, message.point.z)[2])


def truth_pose(message: Any, time_ns: int) -> TruthPose:
    """A pose of the base: PoseStamped, PoseWithCovarianceStamped, Odometry or TransformStamped."""
    if hasattr(message, "transform"):
        return TruthPose(time_ns, transform(message.transform))
    pose = message.pose
    pose = getattr(pose, "pose", pose)
    position = pose.position
    return TruthPose(time_ns, Transform(_place("pose", position), quaternion("pose", pose.orientation)))


def transform(message: Any) -> Transform:
    """geometry_msgs/Transform."""
    return Transform(_place("transform", message.translation), quaternion("transform", message.rotation))


def near_base(T_base_laser: Transform) -> Transform:
    """A mount that a robot can have: a frame of the world that was taken for the base may be far away."""
    if max(map(abs, T_base_laser.translation.tolist())) > FARTHEST_LASER:
        raise BadMessage(
            f"laser more than {FARTHEST_LASER:g} m from the base by tf, give another --base-frame or --laser-pose"
        )
    return T_base_laser


def quaternion(what: str, q: Any) -> Float64s:
    """A geometry_msgs/Quaternion as unit w, x, y, z."""
    norm = math.sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z)
    if not (math.isfinite(norm) and norm > 1e-6):
        raise BadMessage(f"{what} with a zero or NaN quaternion")
    size = math.copysign(norm, q.w)
    return np.array([q.w / size, q.x / size, q.y / size, q.z / size])


def finite_vector(what: str, x: float, y: float, z: float) -> Float64s:
    """(3,) of three components; `what` is named if one is not finite."""
    if not (math.isfinite(x) and math.isfinite(y) and math.isfinite(z)):
        raise BadMessage(f"{what} with NaN or infinite values")
    return np.array([x, y, z])


def _place(what: str, p: Any) -> Float64s:
    """(3,) of a point or a vector, no further out than anything can be."""
    place = finite_vector(what, p.x, p.y, p.z)
    if max(map(abs, place.tolist())) > PLAUSIBLE:
        raise BadMessage(f"{what} of more than {PLAUSIBLE:g} m")
    return place


def _finite(value: float, otherwise: float) -> float:
    return float(value) if math.isfinite(value) else otherwise


def _time_increment(message: Any, n: int) -> float:
    """Seconds between rays; 0 (all at once) where the driver leaves it out or writes nonsense."""
    value = _finite(message.time_increment, 0.0)
    return value if 0.0 < value * n < MAX_SWEEP_S else 0.0


def _range_max(message: Any) -> float:
    return float(message.range_max) if message.range_max > SHORTEST_RANGE else math.inf
