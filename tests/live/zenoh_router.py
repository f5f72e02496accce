"""Replays a recording by Zenoh, as a robot with rmw_zenoh and its router would serve it.

Run as a program of its own, so that it can be killed like one:
    python -m tests.live.zenoh_router RECORDING --topics /scan /imu [--port 7447] [--speed 4] [--begin 2]
One session in the mode of a router stands in for the router, and publishes. It says "listening PORT", waits until
somebody has subscribed to every topic, and replays once. What is on /tf_static is sent before that, and
kept for who comes later.
"""

import json
import socket
import struct
from typing import Any

import zenoh
from rosbags.highlevel import AnyReader
from rosbags.interfaces import Connection
from rosbags.typesys import Stores, get_typestore
from zenoh import ext

from tests.live.pacing import flags, paced, stay, wait_for

STORE = get_typestore(Stores.ROS2_HUMBLE)
LATCHED = "/tf_static"
IDENTITY = b"\x10" + bytes(range(16))


def router(port: int, *, is_found: bool = False) -> zenoh.Session:
    """One that finds nobody by itself. is_found: it answers those who look for routers."""
    config = zenoh.Config()
    options = {
        "mode": "router",
        "listen/endpoints": [f"tcp/127.0.0.1:{port}"],
        "scouting/multicast/enabled": is_found,
    }
    for key, value in options.items():
        config.insert_json5(key, json.dumps(value))
    return zenoh.open(config)


def announce(session: zenoh.Session, number: int, topic: str, msgtype: str) -> tuple[str, object]:
    """The key of a topic's messages, and the token of its publisher."""
    package, _, name = msgtype.split("/")
    dds_type, type_hash = f"{package}::msg::dds_::{name}_", STORE.hash_rihs01(msgtype)
    qos = ":1:,1:,:,:,," if topic == LATCHED else "::,7:,:,:,,"
    words = ("0", str(session.info.zid()), "0", str(number), "MP", "%", "%", "driver", topic.replace("/", "%"))
    token = "/".join(("@ros2_lv", *words, dds_type, type_hash, qos))
    return f"0/{topic.strip('/')}/{dds_type}/{type_hash}", session.liveliness().declare_token(token)


def publisher(session: zenoh.Session, topic: str, key: str) -> Any:
    """One that keeps its messages for who comes later, if the topic is latched."""
    blocks = zenoh.CongestionControl.BLOCK
    if topic != LATCHED:
        return session.declare_publisher(key, congestion_control=blocks)
    cache = ext.CacheConfig(max_samples=100)
    return ext.declare_advanced_publisher(
        session, key, congestion_control=blocks, cache=cache, publisher_detection=True
    )


def main() -> None:
    args = flags().parse_args()
    if not args.port:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            args.port = free.getsockname()[1]
    session = router(args.port)
    with AnyReader([args.recording], default_typestore=STORE) as reader:
        wanted = [c for c in reader.connections if c.topic in args.topics]
        keys = [announce(session, n, c.topic, c.msgtype) for n, c in enumerate(wanted)]
        publishers = {c.id: publisher(session, c.topic, key) for c, (key, _) in zip(wanted, keys, strict=True)}
        print(f"listening {args.port}", flush=True)
        kept, live = ([c for c in wanted if (c.topic == LATCHED) is is_kept] for is_kept in (True, False))
        numbers = dict.fromkeys(publishers, 0)

        def send(connection: Connection, stamp_ns: int, data: bytes) -> None:
            number = numbers[connection.id] = numbers[connection.id] + 1
            attachment = struct.pack("<qq", number, stamp_ns) + IDENTITY
            publishers[connection.id].put(data, attachment=attachment)

        for message in paced(reader, kept, args):
            send(*message)
        wait_for(lambda: all(publishers[c.id].matching_status.matching for c in live))
        for message in paced(reader, live, args):
            send(*message)
        stay()


if __name__ == "__main__":
    main()
