"""ROS messages for tests: small, valid, and easy to spoil."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from hectorscope.inputs import Item
from hectorscope.ros.converter import Converter
from hectorscope.ros.recorder import Recorder

SECOND = 1_000_000_000
START = 1_700_000_000 * SECOND


class Messages:
    """Makes messages of one generation of ROS. Times: nanoseconds after START; None leaves the stamp at zero."""

    def __init__(self, generation: str = "ros2") -> None:
        self.ros1 = generation == "ros1"
        self.store = get_typestore(Stores.ROS1_NOETIC if self.ros1 else Stores.ROS2_HUMBLE)
        if self.ros1:
            definition = "geometry_msgs/TransformStamped[] transforms"
            self.store.register(get_types_from_msg(definition, "tf2_msgs/msg/TFMessage"))

    def make(self, msgtype: str, **fields: Any) -> Any:
        """A message with all its fields."""
        return self.store.types[msgtype](**fields)

    def header(self, time_ns: int | None, frame: str) -> Any:
        """A std_msgs Header."""
        seconds, nanoseconds = (0, 0) if time_ns is None else divmod(START + time_ns, SECOND)
        stamp = self.make("builtin_interfaces/msg/Time", sec=seconds, nanosec=nanoseconds)
        counter = {"seq": 0} if self.ros1 else {}
        return self.make("std_msgs/msg/Header", **counter, stamp=stamp, frame_id=frame)

    def scan(self, time_ns: int | None = 0, frame: str = "laser", **changes: Any) -> Any:
        """Three beams; `changes` spoils them."""
        ranges = np.asarray(changes.pop("ranges", [1.0, 2.0, 3.0]), np.float32)
        fields = {
            "angle_min": -0.5,
            "angle_max": 0.5,
            "angle_increment": 0.5,
            "time_increment": 0.001,
            "scan_time": 0.1,
            "range_min": 0.1,
            "range_max": 30.0,
        }
        header = self.header(time_ns, frame)
        return self.make(
            "sensor_msgs/msg/LaserScan",
            **{**fields, **changes},
            header=header,
            ranges=ranges,
            intensities=np.zeros(0, np.float32),
        )

    def vector(self, kind: str, x: float, y: float, z: float) -> Any:
        """A Vector3 or Point."""
        return self.make(f"geometry_msgs/msg/{kind}", x=x, y=y, z=z)

    def quaternion(self, w: float = 1.0, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Any:
        """A Quaternion, level by default."""
        return self.make("geometry_msgs/msg/Quaternion", x=x, y=y, z=z, w=w)

    def imu(
        self,
        time_ns: int | None = 0,
        frame: str = "imu",
        rates: Sequence[float] = (0.1, 0.2, 0.3),
        forces: Sequence[float] = (0.0, 0.0, 9.8),
        orientation: Any = None,
        absent: Sequence[str] = (),
    ) -> Any:
        """An Imu at rest; absent: what its covariances deny."""
        covariances = {
            f"{name}_covariance": np.full(9, -1.0 if name in absent else 0.0)
            for name in ("orientation", "angular_velocity", "linear_acceleration")
        }
        return self.make(
            "sensor_msgs/msg/Imu",
            header=self.header(time_ns, frame),
            orientation=orientation or self.quaternion(),
            angular_velocity=self.vector("Vector3", *rates),
            linear_acceleration=self.vector("Vector3", *forces),
            **covariances,
        )

    def pose(self, position: Sequence[float] = (1.0, 2.0, 3.0), orientation: Any = None) -> Any:
        """A Pose."""
        return self.make(
            "geometry_msgs/msg/Pose",
            position=self.vector("Point", *position),
            orientation=orientation or self.quaternion(),
        )

    def pose_stamped(self, time_ns: int | None = 0, **pose: Any) -> Any:
        """A PoseStamped in map."""
        return self.make(
            "geometry_msgs/msg/PoseStamped", header=self.header(time_ns, "map"), pose=self.pose(**pose)
        )

    def odometry(self, time_ns: int | None = 0, vx: float = 0.5, vy: float = 0.1, turn: float = 0.2) -> Any:
        """An Odometry that drives forward."""
        zeros = np.zeros(36)
        twist = self.make(
            "geometry_msgs/msg/Twist",
            linear=self.vector("Vector3", vx, vy, 0.0),
            angular=self.vector("Vector3", 0.0, 0.0, turn),
        )
        return self.make(
            "nav_msgs/msg/Odometry",
            header=self.header(time_ns, "odom"),
            child_frame_id="base_link",
            pose=self.make("geometry_msgs/msg/PoseWithCovariance", pose=self.pose(), covariance=zeros),
            twist=self.make("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=zeros),
        )

    def pressure(self, time_ns: int | None, pascal: float) -> Any:
        """A FluidPressure."""
        return self.make(
            "sensor_msgs/msg/FluidPressure",
            header=self.header(time_ns, "base_link"),
            fluid_pressure=pascal,
            variance=0.0,
        )

    def range(self, time_ns: int | None, metres: float, frame: str = "sonar") -> Any:
        """A Range."""
        return self.make(
            "sensor_msgs/msg/Range",
            header=self.header(time_ns, frame),
            radiation_type=0,
            field_of_view=0.1,
            min_range=0.05,
            max_range=10.0,
            range=metres,
        )

    def magnetic(self, time_ns: int | None, field: Sequence[float], frame: str = "imu") -> Any:
        """A MagneticField, tesla."""
        return self.make(
            "sensor_msgs/msg/MagneticField",
            header=self.header(time_ns, frame),
            magnetic_field=self.vector("Vector3", *field),
            magnetic_field_covariance=np.zeros(9),
        )

    def fix(
        self,
        time_ns: int | None,
        latitude: float,
        longitude: float,
        altitude: float,
        status: int = 0,
        variance: float = 4.0,
        known: int = 2,
    ) -> Any:
        """A NavSatFix; known: the type of its covariance, 0 for none."""
        return self.make(
            "sensor_msgs/msg/NavSatFix",
            header=self.header(time_ns, "gps"),
            status=self.make("sensor_msgs/msg/NavSatStatus", status=status, service=1),
            latitude=latitude,
            longitude=longitude,
            altitude=altitude,
            position_covariance=np.diag([variance, variance, 4.0 * variance]).ravel(),
            position_covariance_type=known,
        )

    def gps_velocity(self, time_ns: int | None, velocity: Sequence[float], *, covariance: bool = False) -> Any:
        """A TwistStamped, or one with covariance."""
        twist = self.make(
            "geometry_msgs/msg/Twist",
            linear=self.vector("Vector3", *velocity),
            angular=self.vector("Vector3", 0.0, 0.0, 0.0),
        )
        header = self.header(time_ns, "gps")
        if not covariance:
            return self.make("geometry_msgs/msg/TwistStamped", header=header, twist=twist)
        covered = self.make("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=np.zeros(36))
        return self.make("geometry_msgs/msg/TwistWithCovarianceStamped", header=header, twist=covered)

    def point(self, time_ns: int | None, z: float) -> Any:
        """A PointStamped."""
        return self.make(
            "geometry_msgs/msg/PointStamped",
            header=self.header(time_ns, "map"),
            point=self.vector("Point", 0.0, 0.0, z),
        )

    def transform_stamped(
        self,
        time_ns: int | None,
        parent: str,
        child: str,
        position: Sequence[float] = (0.0, 0.0, 0.0),
        orientation: Any = None,
    ) -> Any:
        """A TransformStamped."""
        return self.make(
            "geometry_msgs/msg/TransformStamped",
            header=self.header(time_ns, parent),
            child_frame_id=child,
            transform=self.make(
                "geometry_msgs/msg/Transform",
                translation=self.vector("Vector3", *position),
                rotation=orientation or self.quaternion(),
            ),
        )

    def tf(self, *args: Any, **kwargs: Any) -> Any:
        """A TFMessage of one transform."""
        return self.make("tf2_msgs/msg/TFMessage", transforms=[self.transform_stamped(*args, **kwargs)])


def write_bag(path: Path, entries: Sequence[tuple[str, Any, int]]) -> Path:
    """Messages (topic, message, nanoseconds after START) as a .bag, an .mcap, or a sqlite3 folder."""
    with Recorder(path, compress=False) as recorder:
        for topic, message, time_ns in entries:
            recorder.write(topic, message, START + time_ns)
    return path


def feed(converter: Converter, entries: Sequence[tuple[str, Any, int]]) -> list[Item]:
    """Items of messages received at nanoseconds after START."""
    items: list[Item] = []
    for topic, message, ns in entries:
        items += converter.convert(topic, message.__msgtype__, message, START + ns)
    return items
