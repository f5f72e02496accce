"""Results at real servers, heard by clients that know nothing of where they come from."""

import json
import socket
import struct
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from rosbags.typesys import Stores, get_typestore
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

from hectorscope.results.topics import TOPICS
from hectorscope.run.warmup import load_everything
from tests.live.conftest import Replay
from tests.live.measurements import GIVE_UP_S
from tests.live.measurements import TOPICS as OF_THE_ROBOT

NODE = (sys.executable, "-m", "hectorscope.cli.main", "serve")
STORE = get_typestore(Stores.ROS2_HUMBLE)


@pytest.fixture(scope="module", autouse=True)
def _compiled() -> None:
    """A robot that drives for six seconds does not wait until the kernels of a node are compiled."""
    load_everything()


@pytest.fixture
def node() -> Iterator[Callable[..., subprocess.Popen[str]]]:
    """A function that starts `hectorscope serve` with arguments, and waits for what it publishes."""
    running: list[subprocess.Popen[str]] = []

    def start(*arguments: str) -> subprocess.Popen[str]:
        running.append(subprocess.Popen([*NODE, *arguments], stdout=subprocess.PIPE, text=True))
        return running[-1]

    yield start
    for process in running:
        process.kill()
        process.wait()


def free_port() -> int:
    """One that nobody uses now."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port: int = free.getsockname()[1]
        return port


def line(process: subprocess.Popen[str], word: str) -> str:
    """The first line of the output with a word."""
    assert process.stdout is not None
    return next(text for text in process.stdout if word in text)


@contextmanager
def foxglove_client(port: int) -> Iterator[tuple[ClientConnection, dict[int, str]]]:
    """A client that has subscribed to every topic, and the topics by subscription."""
    with connect(
        f"ws://127.0.0.1:{port}", subprotocols=[Subprotocol("foxglove.sdk.v1")], max_size=2**26
    ) as client:
        topics: dict[int, str] = {}
        while len(topics) < len(TOPICS):
            said = json.loads(client.recv(GIVE_UP_S))
            for channel in said.get("channels", ()):
                assert (channel["encoding"], channel["schemaEncoding"]) == ("cdr", "ros2msg")
                assert channel["schemaName"] == TOPICS[channel["topic"]]
                topics[channel["id"]] = channel["topic"]
        wanted = [{"id": number, "channelId": number} for number in topics]
        client.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))
        yield client, topics


def first_of_each(client: ClientConnection, topics: dict[int, str]) -> dict[str, Any]:
    """A message of every topic."""
    heard: dict[str, Any] = {}
    ends = time.monotonic() + GIVE_UP_S
    while len(heard) < len(topics) and time.monotonic() < ends:
        frame = client.recv(GIVE_UP_S)
        if isinstance(frame, bytes) and frame[0] == 1:
            (number,) = struct.unpack_from("<I", frame, 1)
            heard[topics[number]] = STORE.deserialize_cdr(frame[13:], TOPICS[topics[number]])
    return heard


def check(heard: dict[str, Any]) -> None:
    """Map, pose and path are there, in the frames of REP-105."""
    assert heard["/poseupdate"].header.frame_id == heard["/map"].header.frame_id == "map"
    assert heard["/tf"].transforms[0].child_frame_id == "base_link"
    assert set(heard["/map"].data.tolist()) == {-1, 0, 100}
    assert len(heard["/trajectory"].poses) > 0
    assert heard["/diagnostics"].status[0].name == "hectorscope: tracking"


def test_a_node_serves_its_results_to_foxglove(
    drive: Path, replay: Callable[..., Replay], node: Callable[..., subprocess.Popen[str]], tmp_path: Path
) -> None:
    """Every topic is heard by a client of the protocol; the results are saved when the node is asked to end."""
    robot, port = replay(drive, *OF_THE_ROBOT), free_port()
    process = node(robot.uri, "--publish", f"ws://127.0.0.1:{port}", "--out", str(tmp_path / "results"))
    assert str(port) in line(process, "Results are published")
    with foxglove_client(port) as (client, topics):
        check(first_of_each(client, topics))
    process.terminate()
    assert "saved" in line(process, "results").lower()
    process.wait(GIVE_UP_S)
    assert (tmp_path / "results" / "map.npz").is_file()


def refusal(*arguments: str) -> str:
    """What a node says that ends with 2."""
    done = subprocess.run([*NODE, *arguments], capture_output=True, text=True, timeout=GIVE_UP_S, check=False)
    assert done.returncode == 2, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    return done.stderr


def test_a_used_port_is_told() -> None:
    """The command names the port and ends with 2 before anything runs."""
    with socket.socket() as used:
        used.bind(("127.0.0.1", 0))
        used.listen()
        uri = f"ws://127.0.0.1:{used.getsockname()[1]}"
        assert uri in refusal("ws://127.0.0.1:1", "--publish", uri)


def test_a_node_that_leaves_nothing_is_refused() -> None:
    """The flags that it needs are named."""
    message = refusal("ws://127.0.0.1:1")
    assert "--publish" in message
    assert "--out" in message


def test_a_node_of_the_robots_own_domain_is_heard_there(
    drive: Path, replay: Callable[..., Replay], node: Callable[..., subprocess.Popen[str]]
) -> None:
    """Announced as rmw_zenoh does; the map is kept for who comes later; what comes back is not taken for tf."""
    zenoh = pytest.importorskip("zenoh", reason="no eclipse-zenoh here: install hectorscope[zenoh]")
    robot = replay(drive, *OF_THE_ROBOT, scheme="zenoh")
    node(robot.uri, "--publish", robot.uri)
    config = zenoh.Config()
    for key, value in {
        "mode": "client",
        "connect/endpoints": [f"tcp/127.0.0.1:{robot.port}"],
        "scouting/multicast/enabled": False,
    }.items():
        config.insert_json5(key, json.dumps(value))
    with zenoh.open(config) as session:
        heard: dict[str, Any] = {}
        named = {topic: f"0{topic}/**" for topic in TOPICS}
        boxes = {topic: session.declare_subscriber(key) for topic, key in named.items()}
        ends = time.monotonic() + GIVE_UP_S
        while len(heard) < len(boxes) and time.monotonic() < ends:
            for topic, box in boxes.items():
                if (sample := box.try_recv()) is not None:
                    assert len(sample.attachment.to_bytes()) == 33
                    heard[topic] = STORE.deserialize_cdr(sample.payload.to_bytes(), TOPICS[topic])
        tokens = {str(reply.ok.key_expr) for reply in session.liveliness().get("@ros2_lv/0/**")}
    check(heard)
    ours = [token for token in tokens if "/hectorscope/" in token]
    assert sorted(token.split("/")[9].replace("%", "/") for token in ours) == sorted(TOPICS)
