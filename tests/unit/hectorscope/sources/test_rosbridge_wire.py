"""Frames of the rosbridge protocol."""

import json
from typing import Any

import cbor2
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hectorscope.sources._offers import Malformed, Offer, Payload, Withdrawal
from hectorscope.sources._rosbridge_wire import TOPICS, Conversation, ask_topics, subscribe


def answer(*topics: tuple[str, str], **changes: Any) -> str:
    names, types = [name for name, _ in topics], [kind for _, kind in topics]
    said = {"op": "service_response", "id": TOPICS, "values": {"topics": names, "types": types}, "result": True}
    return json.dumps(said | changes)


SCAN, IMU = ("/scan", "sensor_msgs/msg/LaserScan"), ("/imu", "sensor_msgs/Imu")


def test_topics_come_and_go_between_two_answers() -> None:
    """Only what is new is offered, with the serialisation of its generation, and what is gone is withdrawn."""
    talk = Conversation()
    assert talk.parse(answer(SCAN)) == [Offer(1, "/scan", "cdr", "sensor_msgs/msg/LaserScan")]
    assert talk.parse(answer(SCAN, IMU)) == [Offer(2, "/imu", "ros1", "sensor_msgs/Imu")]
    assert talk.parse(answer(IMU)) == [Withdrawal(1)]
    assert talk.parse(answer(IMU)) == []


def test_a_message_carries_its_bytes_and_the_time_of_the_bridge() -> None:
    """By the number of the channel that was subscribed to."""
    talk = Conversation()
    (offer,) = talk.parse(answer(SCAN))
    assert isinstance(offer, Offer)
    talk.subscribed(offer)
    raw = {"secs": 3, "nsecs": 5, "bytes": b"data"}
    frame = cbor2.dumps({"op": "publish", "topic": "/scan", "msg": raw})
    assert talk.parse(frame) == [Payload(1, 3_000_000_005, b"data")]


@pytest.mark.parametrize(
    "changes", [{"result": False, "values": "no such service"}, {"values": None}, {"values": {}}]
)
def test_a_bridge_without_rosapi_is_told(changes: dict[str, Any]) -> None:
    """The remedy is shown while nothing flows; it goes once topics are listed."""
    talk = Conversation()
    assert talk.parse(answer(SCAN, **changes)) == []
    assert "start rosapi beside it" in talk.failure
    talk.parse(answer(SCAN))
    assert talk.failure == ""


@pytest.mark.parametrize(
    "message",
    [
        {"op": "publish", "topic": "/other", "msg": {"secs": 0, "nsecs": 0, "bytes": b""}},
        {"op": "publish", "topic": ["/scan"], "msg": {}},
        {"op": "publish", "topic": "/scan", "msg": {"ranges": []}},
        {"op": "publish", "topic": "/scan", "msg": {"secs": "0", "nsecs": 0, "bytes": b""}},
        {"op": "publish", "topic": "/scan", "msg": {"secs": 0, "nsecs": 0, "bytes": "text"}},
        {"op": "publish", "topic": "/scan", "msg": {"secs": -1, "nsecs": 0, "bytes": b""}},
        {"op": "publish", "topic": "/scan", "msg": {"secs": 2**34, "nsecs": 0, "bytes": b""}},
        {"op": "publish", "topic": "/scan", "msg": {"secs": True, "nsecs": 0, "bytes": b""}},
    ],
)
def test_a_broken_message_is_named(message: dict[str, Any]) -> None:
    """It costs itself."""
    talk = Conversation()
    (offer,) = talk.parse(answer(SCAN))
    assert isinstance(offer, Offer)
    talk.subscribed(offer)
    (event,) = talk.parse(cbor2.dumps(message))
    assert isinstance(event, Malformed)


@given(st.one_of(st.binary(max_size=200), st.text(max_size=200)))
def test_no_frame_raises(frame: str | bytes) -> None:
    """Whatever a server sends is an event, or nothing."""
    for event in Conversation().parse(frame):
        assert isinstance(event, Malformed)


def test_requests_are_those_of_the_protocol() -> None:
    """Topics by the service of rosapi; a subscription asks for raw bytes."""
    assert json.loads(ask_topics())["service"] == "/rosapi/topics"
    asked = json.loads(subscribe(Offer(4, "/scan", "cdr", "sensor_msgs/msg/LaserScan")))
    assert (asked["op"], asked["topic"], asked["compression"]) == ("subscribe", "/scan", "cbor-raw")
