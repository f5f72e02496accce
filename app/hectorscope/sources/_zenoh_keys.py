"""The keys of rmw_zenoh, version 1: where topics are announced, and where their messages are.

A publisher announces itself by a liveliness token,
    @ros2_lv/DOMAIN/SESSION/NODE/ENTITY/MP/ENCLAVE/NAMESPACE/NAME/TOPIC/TYPE/HASH/QOS
in which "%" stands for "/". Its messages are at DOMAIN/TOPIC/TYPE/HASH, without the first "/" of the topic. With
each message come its number, the publisher's time and its identity.
"""

import struct
from dataclasses import dataclass

ALL_TOKENS = "@ros2_lv/{domain}/**"
PUBLISHER = "MP"
PARTS = 13
NO_HASH = "TypeHashNotSupported"  # of ROS 2 Humble
TRANSIENT_LOCAL = "1"
ATTACHMENT = struct.Struct("<qq")  # number and time [ns]; the identity follows


@dataclass(frozen=True, slots=True)
class Publication:
    """A topic in one type. key: of its messages. is_latched: the last message is kept for who comes later."""

    topic: str
    msgtype: str
    type_hash: str
    key: str
    is_latched: bool


def publication(token: str) -> Publication | None:
    """What a token announces; None if it is no publisher's."""
    parts = token.split("/")
    if len(parts) != PARTS or parts[5] != PUBLISHER:
        return None
    domain, topic, dds_type, type_hash, qos = parts[1], parts[9].replace("%", "/"), *parts[10:]
    names = dds_type.removesuffix("_").split("::")
    if len(names) != 4 or names[2] != "dds_" or not dds_type.endswith("_"):
        return None
    durability = qos.split(":")[1] if ":" in qos else ""
    key = f"{domain}/{topic.strip('/')}/{dds_type}/{type_hash}"
    return Publication(topic, f"{names[0]}/{names[1]}/{names[3]}", type_hash, key, durability == TRANSIENT_LOCAL)


def sent_ns(attachment: bytes | None) -> int | None:
    """The publisher's time of a message; None if it does not tell."""
    if attachment is None or len(attachment) < ATTACHMENT.size:
        return None
    time_ns: int = ATTACHMENT.unpack_from(attachment)[1]
    return time_ns if time_ns > 0 else None
