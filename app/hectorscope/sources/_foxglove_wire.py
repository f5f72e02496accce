"""Frames of the Foxglove WebSocket protocol: messages of the server and requests of the client.

Nothing that a server sends is trusted: what cannot be read becomes a `Malformed`, what is not needed here
(services, parameters, the server's clock) is passed over.
"""

import json
import struct
from collections.abc import Sequence
from typing import Any

from websockets.typing import Subprotocol

from hectorscope.sources._offers import Event, Malformed, Offer, Payload, Withdrawal

# The same frames under two names; newer bridges answer only to the first, older ones only to the second.
SUBPROTOCOLS = (Subprotocol("foxglove.sdk.v1"), Subprotocol("foxglove.websocket.v1"))

_MESSAGE_DATA = 0x01
_MESSAGE_HEAD = struct.Struct("<BIQ")  # opcode, subscription, time of reception at the server [ns]
_ID_LIMIT = 2**32


def parse(frame: str | bytes) -> list[Event]:
    """The event in a frame of the server; empty for everything that is not needed."""
    return _parse_text(frame) if isinstance(frame, str) else _parse_binary(frame)


def _parse_binary(frame: bytes) -> list[Event]:
    if not frame:
        return [Malformed("empty frame")]
    if frame[0] != _MESSAGE_DATA:
        return []
    if len(frame) < _MESSAGE_HEAD.size:
        return [Malformed("message frame shorter than its head")]
    _, subscription, received_ns = _MESSAGE_HEAD.unpack_from(frame)
    return [Payload(subscription, received_ns, frame[_MESSAGE_HEAD.size :])]


def _parse_text(frame: str) -> list[Event]:
    try:
        said = json.loads(frame)
    except (ValueError, RecursionError):
        return [Malformed("text frame that is not JSON")]
    if not isinstance(said, dict):
        return [Malformed("text frame that is not an object")]
    if said.get("op") == "advertise":
        return [_offer(channel) for channel in _entries(said, "channels")]
    if said.get("op") == "unadvertise":
        return [_withdrawal(channel) for channel in _entries(said, "channelIds")]
    return []


def _entries(said: dict[str, Any], key: str) -> list[Any]:
    entries = said.get(key)
    return entries if isinstance(entries, list) else [None]


def _offer(channel: Any) -> Event:
    try:
        texts = [channel[key] for key in ("topic", "encoding", "schemaName", "schema")]
        number = channel["id"]
    except (TypeError, KeyError):
        return Malformed("advertised channel without its fields")
    if not _is_id(number) or not all(isinstance(text, str) for text in texts):
        return Malformed("advertised channel with fields of the wrong type")
    return Offer(number, *texts)


def _withdrawal(number: Any) -> Event:
    return Withdrawal(number) if _is_id(number) else Malformed("withdrawn channel without a number")


def _is_id(number: Any) -> bool:
    return isinstance(number, int) and not isinstance(number, bool) and 0 <= number < _ID_LIMIT


def subscribe(channels: Sequence[int]) -> str:
    """The request for channels. Each subscription takes the number of its channel, which is as unique."""
    wanted = [{"id": channel, "channelId": channel} for channel in channels]
    return json.dumps({"op": "subscribe", "subscriptions": wanted})
