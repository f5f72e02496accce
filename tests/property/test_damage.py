"""Whatever happens to a recording's bytes, reading it ends with measurements or with one clear sentence."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from hectorscope.checks.inspect import inspect_bag
from hectorscope.inputs import SourceError, SourceOptions
from hectorscope.sources import open_source
from tests.ros_messages import SECOND, Messages, write_bag


@cache
def sound(folder: Path, suffix: str) -> bytes:
    """The bytes of a small recording: scans, an IMU, truth, a mount and a tf that moves."""
    ros = Messages("ros1" if suffix == ".bag" else "ros2")
    entries = [("/tf_static", ros.tf(0, "base_link", "laser", (0.2, 0.0, 0.1)), 0)]
    for t in range(0, 2 * SECOND, SECOND // 10):
        entries.append(("/scan", ros.scan(t, ranges=np.full(50, 2.0), angle_increment=0.01), t))
        entries.append(("/imu", ros.imu(t, "base_link"), t))
        entries.append(("/ground_truth", ros.pose_stamped(t), t))
        entries.append(("/tf", ros.tf(t, "odom", "base_link", (t / SECOND, 0.0, 0.0)), t))
    path = write_bag(folder / ("sound" + suffix.replace(".db3", "")), entries)
    return (path if path.is_file() else next(path.glob("*.db3"))).read_bytes()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One folder for all examples."""
    return tmp_path_factory.mktemp("damage")


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    suffix=st.sampled_from([".bag", ".mcap", ".db3"]),
    where=st.floats(0.0, 1.0, exclude_max=True),
    patch=st.none() | st.binary(min_size=1, max_size=40),
    insert=st.booleans(),
)
def test_damage_never_crashes(folder: Path, suffix: str, where: float, patch: bytes | None, insert: bool) -> None:
    """Cut (no patch), overwritten or shifted at any place: items are read, or a SourceError says why not."""
    data = sound(folder, suffix)
    at = int(where * len(data))
    rest = b"" if patch is None else data[at if insert else at + len(patch) :]
    path = folder / f"damaged{suffix}"
    path.write_bytes(data[:at] + (patch or b"") + rest)
    try:
        source = open_source(str(path), SourceOptions())
        count = sum(1 for _ in source.items())
        assert count <= 4 * 20 + 1
        assert str(inspect_bag(path, SourceOptions()))
    except SourceError as error:
        assert path.name in str(error)
