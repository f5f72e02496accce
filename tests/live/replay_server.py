"""Replays a recording on a real Foxglove server, as the bridge of a robot would serve it.

Run as a program of its own, so that it can be killed like one:
    python -m tests.live.replay_server RECORDING --topics /scan /imu [--port 8765] [--speed 4]
        [--begin 2] [--end 8]
It says "listening PORT", waits until somebody has subscribed to every topic, and replays once. With --stamps each
message's topic and the monotonic time at which it was sent are written to that file.
"""

import argparse
import time
from pathlib import Path

import foxglove
from foxglove import Channel, Context, Schema
from rosbags.highlevel import AnyReader
from rosbags.interfaces import Connection
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.msg import denormalize_msgtype

from tests.live.pacing import flags, paced, stay, wait_for


def make_channel(context: Context, reader: AnyReader, connection: Connection) -> Channel:
    """A channel as the bridges advertise it: message and schema encoded as the recording has them."""
    if reader.is2:
        name, encoding, schema_encoding = connection.msgtype, "cdr", "ros2msg"
    else:
        name, encoding, schema_encoding = denormalize_msgtype(connection.msgtype), "ros1", "ros1msg"
    text = connection.msgdef.data or reader.typestore.generate_msgdef(connection.msgtype, ros_version=2)[0]
    schema = Schema(name=name, encoding=schema_encoding, data=text.encode())
    return Channel(connection.topic, schema=schema, message_encoding=encoding, context=context)


def replay(reader: AnyReader, channels: dict[int, Channel], args: argparse.Namespace) -> list[str]:
    """Send every message at its time; tells when each was sent."""
    sent = []
    connections = [c for c in reader.connections if c.id in channels]
    for connection, stamp_ns, data in paced(reader, connections, args):
        sent.append(f"{connection.topic} {time.monotonic_ns()}")
        channels[connection.id].log(data, log_time=stamp_ns)
    return sent


def main() -> None:
    parser = flags()
    parser.add_argument("--backlog", type=int, default=1024)
    parser.add_argument("--stamps", type=Path)
    args = parser.parse_args()
    context = Context()
    store = get_typestore(Stores.ROS2_HUMBLE)
    with AnyReader([args.recording], default_typestore=store) as reader:
        wanted = [c for c in reader.connections if c.topic in args.topics]
        channels = {c.id: make_channel(context, reader, c) for c in wanted}
        server = foxglove.start_server(
            host="127.0.0.1", port=args.port, context=context, message_backlog_size=args.backlog
        )
        print(f"listening {server.port}", flush=True)
        wait_for(lambda: all(channel.has_sinks() for channel in channels.values()))
        sent = replay(reader, channels, args)
        if args.stamps:
            args.stamps.write_text("\n".join(sent))
        print("replayed", flush=True)
        stay()


if __name__ == "__main__":
    main()
