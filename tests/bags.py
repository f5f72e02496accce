"""Small recordings in every container."""

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from hectorscope.inputs import Source, SourceOptions
from hectorscope.sources import open_source
from tests.ros_messages import SECOND, Messages

TENTH = SECOND // 10
CONTAINERS = ["run.bag", "run.mcap", "run"]


def messages_for(name: str) -> Messages:
    return Messages("ros1" if name.endswith(".bag") else "ros2")


def small_run(ros: Messages, n: int = 50) -> list[tuple[str, Any, int]]:
    """Scans at 10 Hz at rest with an IMU and truth; the mount comes last, as latched transforms may."""
    entries: list[tuple[str, Any, int]] = []
    for i in range(n):
        t = i * TENTH
        entries.append(("/scan", ros.scan(t, ranges=np.full(100, 2.0 + i / 1000), angle_increment=0.01), t))
        entries.append(("/imu", ros.imu(t + 1, "base_link"), t + 1))
        entries.append(("/ground_truth", ros.pose_stamped(t + 2), t + 2))
    mount = ros.tf(0, "base_link", "laser", (0.2, 0.0, 0.1))
    return [*entries, ("/tf_static", mount, n * TENTH)]


def open_run(path: Path, **options: Any) -> Source:
    return open_source(str(path), SourceOptions(**options))


def kinds(source: Source) -> dict[type, int]:
    return dict(Counter(type(item) for item in source.items()))
