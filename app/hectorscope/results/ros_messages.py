"""Results as ROS 2 messages, by the definitions of rosbags: map, path, pose, tf, diagnostics."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rosbags.typesys import Stores, get_typestore

from hectorscope.run.map_image import MapImage
from hectorscope.run.wording import verdict_text
from slam_core.measurements import Transform
from slam_core.results import StepResult, Tracking

MAP, BASE = "map", "base_link"
STORE = get_typestore(Stores.ROS2_JAZZY)
CELLS = np.array([-1, 0, 100], np.int8)  # of an occupancy grid: unknown, free, occupied
# Levels of diagnostic_msgs/DiagnosticStatus.
OK, WARN, ERROR = 0, 1, 2
LEVELS: Mapping[Tracking, int] = {"tracking": OK, "recovered": OK, "degraded": WARN, "lost": ERROR}
PLANAR = [0, 1, 5]  # x, y, yaw among x, y, z, roll, pitch, yaw


def made(msgtype: str, /, **fields: Any) -> Any:
    """Make a message of "std_msgs/Header" or the like, all fields given."""
    return STORE.types[msgtype.replace("/", "/msg/")](**fields)


def header(stamp_ns: int, frame: str = MAP) -> Any:
    """std_msgs/Header."""
    stamp = made("builtin_interfaces/Time", sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9)
    return made("std_msgs/Header", stamp=stamp, frame_id=frame)


def pose(values: Iterable[float]) -> Any:
    """geometry_msgs/Pose of x, y, z, qw, qx, qy, qz."""
    x, y, z, qw, qx, qy, qz = values
    return made(
        "geometry_msgs/Pose",
        position=made("geometry_msgs/Point", x=x, y=y, z=z),
        orientation=made("geometry_msgs/Quaternion", x=qx, y=qy, z=qz, w=qw),
    )


def values_of(result: StepResult) -> list[float]:
    """T_map_base as `pose` takes it."""
    T = result.T_map_base
    return [*T.translation.tolist(), *T.rotation.tolist()]


def transforms(stamp_ns: int, child: str, T: Transform) -> Any:
    """tf2_msgs/TFMessage with a frame in the map. T: T_map_child."""
    x, y, z = T.translation.tolist()
    qw, qx, qy, qz = T.rotation.tolist()
    transform = made(
        "geometry_msgs/Transform",
        translation=made("geometry_msgs/Vector3", x=x, y=y, z=z),
        rotation=made("geometry_msgs/Quaternion", x=qx, y=qy, z=qz, w=qw),
    )
    stamped = made(
        "geometry_msgs/TransformStamped", header=header(stamp_ns), child_frame_id=child, transform=transform
    )
    return made("tf2_msgs/TFMessage", transforms=[stamped])


def covariance(result: StepResult) -> NDArray[np.float64]:
    """(6, 6) of x, y, z, roll, pitch, yaw: the fused pose in the plane, and height, roll and pitch of the filter.

    Without a filter the last three are 0: the pose keeps what is given for them.
    """
    P = np.zeros((6, 6))
    if result.navigation is not None:
        variances = np.diag(result.navigation.covariance)  # attitude, position, ...
        P[2, 2], P[3, 3], P[4, 4] = variances[5], variances[0], variances[1]
    P[np.ix_(PLANAR, PLANAR)] = result.fused.covariance
    return P


def pose_with_covariance(result: StepResult) -> Any:
    """geometry_msgs/PoseWithCovarianceStamped."""
    both = made(
        "geometry_msgs/PoseWithCovariance", pose=pose(values_of(result)), covariance=covariance(result).ravel()
    )
    return made("geometry_msgs/PoseWithCovarianceStamped", header=header(result.stamp_ns), pose=both)


def path(trajectory: NDArray[np.float64], start_ns: int, stamp_ns: int) -> Any:
    """nav_msgs/Path of the rows of a trajectory (n, 8)."""
    poses = [
        made("geometry_msgs/PoseStamped", header=header(start_ns + round(row[0] * 1e9)), pose=pose(row[1:]))
        for row in trajectory.tolist()
    ]
    return made("nav_msgs/Path", header=header(stamp_ns), poses=poses)


def occupancy(image: MapImage, stamp_ns: int) -> Any:
    """nav_msgs/OccupancyGrid: -1 unknown, 0 free, 100 occupied."""
    rows, columns = image.cells.shape
    info = made(
        "nav_msgs/MapMetaData",
        map_load_time=header(stamp_ns).stamp,
        resolution=image.resolution,
        width=columns,
        height=rows,
        origin=pose((image.x, image.y, 0.0, 1.0, 0.0, 0.0, 0.0)),
    )
    return made("nav_msgs/OccupancyGrid", header=header(stamp_ns), info=info, data=CELLS[image.cells].ravel())


def diagnostics(result: StepResult, figures: Mapping[str, float], warnings: Iterable[str]) -> Any:
    """diagnostic_msgs/DiagnosticArray: the tracking with the figures of the scan, and each warning."""
    statuses = [
        status(
            "hectorscope: tracking",
            LEVELS[result.tracking],
            verdict_text(result.verdict) or result.tracking,
            figures,
        ),
        *(
            status(f"hectorscope: warning {number}", WARN, text, {})
            for number, text in enumerate(warnings, start=1)
        ),
    ]
    return made("diagnostic_msgs/DiagnosticArray", header=header(result.stamp_ns), status=statuses)


def status(name: str, level: int, message: str, figures: Mapping[str, float]) -> Any:
    """diagnostic_msgs/DiagnosticStatus."""
    values = [made("diagnostic_msgs/KeyValue", key=key, value=f"{value:.6g}") for key, value in figures.items()]
    return made(
        "diagnostic_msgs/DiagnosticStatus", level=level, name=name, message=message, hardware_id="", values=values
    )
