"""Frames of the Foxglove protocol."""

import json
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hectorscope.sources._foxglove_wire import parse, subscribe
from hectorscope.sources._offers import Malformed, Offer, Payload, Withdrawal

CHANNEL = {"id": 4, "topic": "/scan", "encoding": "cdr", "schemaName": "sensor_msgs/msg/LaserScan", "schema": "x"}


def test_message_data_is_taken_apart() -> None:
    """A binary message carries its subscription, the server's time, and the serialised message."""
    frame = b"\x01" + struct.pack("<IQ", 7, 123_456_789_012) + b"payload"
    assert parse(frame) == [Payload(7, 123_456_789_012, b"payload")]


def test_advertised_and_withdrawn_channels_are_told_apart() -> None:
    """Channels come and go in lists; fields that are not needed are passed over."""
    extra = CHANNEL | {"id": 5, "schemaEncoding": "ros2msg"}
    offers = parse(json.dumps({"op": "advertise", "channels": [CHANNEL, extra]}))
    assert offers == [
        Offer(4, "/scan", "cdr", "sensor_msgs/msg/LaserScan", "x"),
        Offer(5, "/scan", "cdr", "sensor_msgs/msg/LaserScan", "x"),
    ]
    assert parse('{"op": "unadvertise", "channelIds": [4, 5]}') == [Withdrawal(4), Withdrawal(5)]


@pytest.mark.parametrize(
    "frame", ['{"op": "serverInfo", "name": "x"}', '{"op": "status", "level": 2}', "{}", b"\x02" + bytes(8)]
)
def test_what_is_not_needed_is_passed_over(frame: str | bytes) -> None:
    """Greetings, status lines and the server's clock say nothing to us and are no fault."""
    assert parse(frame) == []


@pytest.mark.parametrize(
    "frame",
    [
        "",
        "[" * 100_000,
        "[1]",
        '{"op": "advertise"}',
        '{"op": "advertise", "channels": [{"id": 4}]}',
        json.dumps({"op": "advertise", "channels": [CHANNEL | {"id": -1}]}),
        json.dumps({"op": "advertise", "channels": [CHANNEL | {"id": True}]}),
        json.dumps({"op": "advertise", "channels": [CHANNEL | {"id": 2**32}]}),
        json.dumps({"op": "advertise", "channels": [CHANNEL | {"topic": None}]}),
        '{"op": "unadvertise", "channelIds": ["4"]}',
        b"",
        b"\x01\x00\x00",
    ],
)
def test_what_cannot_be_read_is_named(frame: str | bytes) -> None:
    """A frame that breaks the protocol becomes one Malformed with a reason, never an exception."""
    (event,) = parse(frame)
    assert isinstance(event, Malformed)
    assert event.reason


def test_one_bad_channel_does_not_take_the_others_along() -> None:
    """In a list of channels only the broken entry is lost."""
    events = parse(json.dumps({"op": "advertise", "channels": [CHANNEL, None, CHANNEL | {"id": 6}]}))
    assert [type(event) for event in events] == [Offer, Malformed, Offer]


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.sampled_from(["id", "topic", "x"]), inner),
)


@given(st.sampled_from(["advertise", "unadvertise"]), JSON)
def test_no_json_breaks_the_reader(op: str, content: object) -> None:
    """Whatever a server puts into its lists, reading it gives events."""
    for event in parse(json.dumps({"op": op, "channels": content, "channelIds": content})):
        assert isinstance(event, Offer | Withdrawal | Malformed)


@given(st.binary())
def test_no_bytes_break_the_reader(frame: bytes) -> None:
    """Whatever bytes arrive, reading them gives events."""
    for event in parse(frame):
        assert isinstance(event, Payload | Malformed)


def test_subscriptions_take_the_numbers_of_their_channels() -> None:
    """A payload's subscription can be looked up by the channel's number."""
    assert json.loads(subscribe([3, 9])) == {
        "op": "subscribe",
        "subscriptions": [{"id": 3, "channelId": 3}, {"id": 9, "channelId": 9}],
    }
