"""Frames of the rosbridge protocol (version 2): what is asked of the bridge, and what it answers.

Topics come from rosapi, which the bridge's launch files start beside it. Messages come as raw bytes in CBOR
("cbor-raw"), serialised as the robot itself does it. Nothing that the bridge sends is trusted.
"""

import json
from typing import Any

import cbor2

from hectorscope.sources._offers import Event, Malformed, Offer, Payload, Withdrawal

TOPICS = "topics"  # the id of the request for topics
MOST_TOPICS = 10_000
NANOSECONDS = 1_000_000_000
LATEST_NS = 2**63  # times are signed numbers of 64 bits


def ask_topics() -> str:
    """The request for the topics with their types."""
    return json.dumps({"op": "call_service", "id": TOPICS, "service": "/rosapi/topics", "args": {}})


def subscribe(offer: Offer) -> str:
    """The request for a topic, message by message as they come."""
    fields = {"topic": offer.topic, "type": offer.schema_name, "compression": "cbor-raw"}
    return json.dumps({"op": "subscribe", "id": f"topic {offer.id}", **fields})


class Conversation:
    """What one connection has said so far: its topics get numbers, as its messages only carry their names."""

    def __init__(self) -> None:
        self._offers: dict[tuple[str, str], Offer] = {}
        self._numbers: dict[str, int] = {}
        self._next = 0
        self.failure = ""

    def parse(self, frame: str | bytes) -> list[Event]:
        """The events of a frame; none for what is not needed."""
        if not frame:
            return []
        said = _decoded(frame)
        if said is None:
            return [Malformed("frame that is neither JSON nor CBOR")]
        match said.get("op"):
            case "publish":
                return [self._payload(said)]
            case "service_response" if said.get("id") == TOPICS:
                return self._topics(said)
        return []

    def subscribed(self, offer: Offer) -> None:
        """Its messages are those of this channel from now on."""
        self._numbers[offer.topic] = offer.id

    def _payload(self, said: dict[str, Any]) -> Event:
        topic, raw = said.get("topic"), said.get("msg")
        number = self._numbers.get(topic) if isinstance(topic, str) else None
        if number is None:
            return Malformed("message of a topic that was not asked for")
        try:
            seconds, nanoseconds, data = raw["secs"], raw["nsecs"], raw["bytes"]  # type: ignore[index]
        except (TypeError, KeyError):
            return Malformed("message without its raw bytes: the bridge has to know cbor-raw")
        if not (type(seconds) is type(nanoseconds) is int and isinstance(data, bytes)):  # True is no number
            return Malformed("message with fields of the wrong type")
        received_ns = seconds * NANOSECONDS + nanoseconds
        if not 0 <= received_ns < LATEST_NS:
            return Malformed("message with a time that is none")
        return Payload(number, received_ns, data)

    def _topics(self, said: dict[str, Any]) -> list[Event]:
        """What is new since the last answer, and what is gone."""
        values = said.get("values")
        names, types = (
            (values.get(key) for key in ("topics", "types")) if isinstance(values, dict) else (None, None)
        )
        if said.get("result") is not True or not (isinstance(names, list) and isinstance(types, list)):
            self.failure = "the bridge does not list its topics: start rosapi beside it"
            return []
        self.failure = ""
        there = {
            (name, kind)
            for name, kind in zip(names[:MOST_TOPICS], types[:MOST_TOPICS], strict=False)
            if isinstance(name, str) and isinstance(kind, str)
        }
        gone = [self._offers.pop(key) for key in set(self._offers) - there]
        events: list[Event] = [Withdrawal(offer.id) for offer in gone]
        return events + [self._offer(*key) for key in sorted(there - set(self._offers))]

    def _offer(self, topic: str, kind: str) -> Offer:
        self._next += 1
        encoding = "cdr" if kind.count("/") > 1 else "ros1"  # pkg/msg/Name is of ROS 2
        offer = self._offers[topic, kind] = Offer(self._next, topic, encoding, kind)
        return offer


def _decoded(frame: str | bytes) -> dict[str, Any] | None:
    try:
        said = json.loads(frame) if isinstance(frame, str) else cbor2.loads(frame)
    except (ValueError, RecursionError, cbor2.CBORError):
        return None
    return said if isinstance(said, dict) else None
