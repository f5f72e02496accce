"""ROS 2 by DDS: domains, and types whose samples are the serialised messages.

Publishers tell the hash of their type in their user data (REP 2016), from ROS 2 Iron on.
"""

import importlib
import re
from functools import cache
from typing import Any

from hectorscope.ros.dds_names import dds_type
from slam_core.errors import SlamError

FORM = "dds://DOMAIN"
HIGHEST = 232  # domain: those beyond would have ports above 65535
ADDRESS = re.compile(r"dds://(\d{1,3})/?", re.ASCII)
MODULE = "cyclonedds"
BARRED = "cannot be joined: check the network, and CYCLONEDDS_URI if set"
BLOCKS_NS = 100_000_000  # the longest that a reliable writer waits for a slow reader
_HASH = re.compile(rb"typehash=(RIHS01_[0-9a-f]{64});")


def domain(uri: str, refusal: type[SlamError]) -> int:
    """The domain that an address names; `refusal` for an address of another form, or without the library."""
    found = ADDRESS.fullmatch(uri)
    if found is None or int(found[1]) > HIGHEST:
        raise refusal(f"{uri} is no DDS domain: give {FORM}, a number from 0 to {HIGHEST}, such as dds://0")
    try:
        importlib.import_module(MODULE)  # of the extra `dds`
    except ImportError as error:
        raise refusal(f"{uri} needs {MODULE}: install hectorscope[dds], on Python 3.13 or older") from error
    return int(found[1])


def user_data(type_hash: str) -> bytes:
    """What a publisher tells of its type."""
    return f"typehash={type_hash};".encode()


def type_hash(data: bytes) -> str:
    """The hash in the user data of a publisher; "" if it does not tell."""
    found = _HASH.search(data)
    return found[1].decode() if found else ""


def quality(*, is_reliable: bool, is_latched: bool, depth: int) -> list[Any]:
    """The qualities of service of a reader or writer. is_latched: messages are kept for who comes later."""
    from cyclonedds.qos import Policy  # noqa: PLC0415 - of the extra `dds`

    reliability = Policy.Reliability.Reliable(BLOCKS_NS) if is_reliable else Policy.Reliability.BestEffort
    durability = Policy.Durability.TransientLocal if is_latched else Policy.Durability.Volatile
    return [reliability, durability, Policy.History.KeepLast(depth)]


@cache
def raw_type(msgtype: str) -> Any:
    """A type of the name that a message has in DDS. Its samples are serialised messages, which nobody reads here.

    One class for each name, as DDS compares the types of one process.
    """
    from cyclonedds.idl import IdlStruct, types  # noqa: PLC0415

    class Raw(IdlStruct, typename=dds_type(msgtype)):  # type: ignore[misc, call-arg]
        """data: with the header that tells the encoding."""

        first: types.byte  # DDS looks for what is declared; no message is shorter

        def __init__(self, data: bytes) -> None:
            self.data = bytes(data)

        def serialize(self, **_: Any) -> bytes:
            return self.data

        @classmethod
        def deserialize(cls, data: bytes) -> "Raw":
            return cls(data)

        deserialize_key = deserialize

    return Raw
