"""Robots that are looked for, and scans in Foxglove's own schema, against the real server."""

import base64
import contextlib
import json
import math
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import foxglove
import numpy as np
import pytest
from foxglove import Channel, Context, Schema, messages
from foxglove.channels import LaserScanChannel
from hypothesis import given, settings
from hypothesis import strategies as st

from hectorscope.cli.discovery import Found, look, told
from hectorscope.inputs import Source, SourceError
from hectorscope.ros.decode import BadDefinition
from hectorscope.ros.foxglove_scan import to_cdr
from hectorscope.ros.messages import BadMessage
from hectorscope.ros.stream_recorder import StreamRecorder
from hectorscope.sources.rmw_zenoh import scouted
from slam_core.measurements import LaserScan
from tests.live.conftest import Replay
from tests.live.measurements import TOPICS, opened, plain
from tests.live.test_publishing import free_port

SCAN = {
    "timestamp": {"sec": 5, "nsec": 250_000_000},
    "frame_id": "laser",
    "pose": {"position": {"x": 0, "y": 0, "z": 0}, "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}},
    "start_angle": -1.0,
    "end_angle": 1.0,
    "ranges": [1.0, 2.0, None, 4.0, 5.0],
    "intensities": [],
}


@pytest.fixture
def json_robot() -> Iterator[tuple[str, Channel]]:
    """A server with one channel of foxglove.LaserScan in JSON."""
    context = Context()
    schema = Schema(name="foxglove.LaserScan", encoding="jsonschema", data=b'{"type": "object"}')
    channel = Channel("/scan", schema=schema, message_encoding="json", context=context)
    server = foxglove.start_server(host="127.0.0.1", port=0, context=context)
    yield f"ws://127.0.0.1:{server.port}", channel
    server.stop()


def heard(uri: str, channel: Any, *said: Any, recorder: StreamRecorder | None = None) -> tuple[LaserScan, Source]:
    """The first scan of a robot that says this once somebody listens, and the source that heard it."""

    def say() -> None:
        while not channel.has_sinks():
            threading.Event().wait(0.01)
        for message in said:
            channel.log(message)

    with opened(uri) as source:
        if recorder is not None:
            source.tap(recorder)  # type: ignore[attr-defined]
        threading.Thread(target=say).start()
        return next(item for item in source.items() if isinstance(item, LaserScan)), source


def test_a_scan_in_json_is_a_scan(json_robot: tuple[str, Channel], tmp_path: Path) -> None:
    """With its angles, its stamp, and no distance where there is null; its recording gives the same."""
    uri, channel = json_robot
    recorder = StreamRecorder(tmp_path)
    moved = {**SCAN, "pose": {"position": {"x": 1.0}}}
    scan, source = heard(uri, channel, json.dumps(moved).encode(), json.dumps(SCAN).encode(), recorder=recorder)
    recorder.close()
    assert any("pose of its own" in reason for reason in source.report.skipped)
    assert scan.stamp_ns == 5_250_000_000
    assert np.array_equal(scan.ranges, np.array([1.0, 2.0, math.nan, 4.0, 5.0], np.float32), equal_nan=True)
    with opened(tmp_path) as source:
        (again,) = (item for item in source.items() if isinstance(item, LaserScan))
    assert plain(again) == plain(scan)


def test_a_scan_in_protobuf_is_that_in_json(json_robot: tuple[str, Channel]) -> None:
    """As foxglove-sdk itself sends it, with the descriptors of its schema."""
    context = Context()
    channel = LaserScanChannel("/scan", context=context)
    server = foxglove.start_server(host="127.0.0.1", port=0, context=context)

    def message(x: float) -> messages.LaserScan:
        turn = messages.Quaternion(x=0.0, y=0.0, z=0.0, w=1.0)
        pose = messages.Pose(position=messages.Vector3(x=x, y=0.0, z=0.0), orientation=turn)
        return messages.LaserScan(
            timestamp=messages.Timestamp(sec=5, nsec=250_000_000),
            frame_id="laser",
            pose=pose,
            start_angle=-1.0,
            end_angle=1.0,
            ranges=[1.0, 2.0, math.nan, 4.0, 5.0],
            intensities=[],
        )

    try:
        scan, source = heard(f"ws://127.0.0.1:{server.port}", channel, message(1.0), message(0.0))
    finally:
        server.stop()
    assert any("pose of its own" in reason for reason in source.report.skipped)
    uri, other = json_robot
    assert plain(scan) == plain(heard(uri, other, json.dumps(SCAN).encode())[0])


@pytest.mark.parametrize("schema", ["", "AAAA", "no base 64!", base64.b64encode(b"\xff" * 40).decode()])
def test_a_definition_that_is_none_is_refused(schema: str) -> None:
    """By name, when the channel is offered."""
    with pytest.raises(BadDefinition, match=r"does not define foxglove\.LaserScan"):
        to_cdr("protobuf", schema)


@settings(max_examples=200)
@given(st.binary(max_size=200))
def test_protobuf_that_is_no_scan_is_skipped(data: bytes) -> None:
    """Whatever a stranger sends: a scan or a counted message, and no other error."""
    schema = base64.b64encode(messages.LaserScan.get_schema().data).decode()
    with contextlib.suppress(BadMessage):
        to_cdr("protobuf", schema)(data)


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"[]",
        b"{}",
        json.dumps({**SCAN, "ranges": "many"}).encode(),
        json.dumps({**SCAN, "ranges": []}).encode(),
        json.dumps({**SCAN, "ranges": [[1.0]]}).encode(),
        json.dumps({**SCAN, "start_angle": None}).encode(),
        json.dumps({**SCAN, "timestamp": {"sec": "now", "nsec": 0}}).encode(),
        json.dumps({**SCAN, "timestamp": {"sec": 2**80, "nsec": 0}}).encode(),
        json.dumps({**SCAN, "pose": 7}).encode(),
        b"[" * 100_000,
    ],
)
def test_json_that_is_no_scan_is_skipped(data: bytes) -> None:
    """Whatever a stranger sends: a counted message, and no other error."""
    with pytest.raises(BadMessage):
        to_cdr("json", "")(data)


def test_robots_are_found_with_their_scans(drive: Path, replay: Callable[..., Replay]) -> None:
    """A bridge that answers is listed with its laser; what does not listen, and what is no bridge, is not."""
    bridge = replay(drive, *TOPICS).uri
    with socket.create_server(("127.0.0.1", 0)) as silent:
        nobody = f"ws://127.0.0.1:{silent.getsockname()[1]}"
    found = look((bridge, nobody))
    assert found == [Found(bridge, 5, ("/scan",))]
    assert f"hectorscope live {bridge}" in told(found)
    assert "scans on /scan" in told(found)


def test_a_zenoh_router_is_found_without_its_address() -> None:
    """It answers in the network, wherever it listens."""
    if not hears_itself():
        pytest.skip("this machine has no network with multicast")
    pytest.importorskip("zenoh", reason="no eclipse-zenoh here: install hectorscope[zenoh]")
    from tests.live.zenoh_router import router  # noqa: PLC0415 - needs zenoh

    with router(port := free_port(), is_found=True):
        assert f"zenoh://127.0.0.1:{port}" in scouted()
    assert f"zenoh://127.0.0.1:{port}" not in scouted()


def hears_itself() -> bool:
    """Whether a multicast comes back to this machine, by the way that discovery takes."""
    group = ("224.0.0.224", free_port())
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listener, contextlib.suppress(OSError):
        listener.settimeout(1.0)
        listener.bind(("", group[1]))
        member = socket.inet_aton(group[0]) + socket.inet_aton("0.0.0.0")
        listener.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            sender.sendto(b"here", group)
        return listener.recv(16) == b"here"
    return False


def test_without_a_robot_the_remedy_is_told() -> None:
    """In one line, with the places that were looked at."""
    with pytest.raises(SourceError, match=r"8765.*start its bridge, or give its ADDRESS"):
        told([])


def test_the_command_without_an_address_looks() -> None:
    """It ends with a list, or with the exit code of a mistake where nothing answers."""
    command = [sys.executable, "-m", "hectorscope.cli.main", "live"]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode in (0, 2)
    assert "Traceback" not in result.stderr
    assert ("no robot was found" in result.stderr) == (result.returncode == 2)
