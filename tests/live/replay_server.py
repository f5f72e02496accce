"""Replays a recording on a real Foxglove server, as the bridge of a robot would serve it.

Run as a program of its own, so that it can be killed like one:
    python replay_server.py RECORDING --topics /scan /imu [--port 8765] [--speed 4] [--begin 2] [--end 8]
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


def make_channel(context: Context, reader: AnyReader, connection: Connection) -> Channel:
    """A channel as the bridges advertise it: message and schema encoded as the recording has them."""
    if reader.is2:
        name, encoding, schema_encoding = connection.msgtype, "cdr", "ros2msg"
    else:
        name, encoding, schema_encoding = denormalize_msgtype(connection.msgtype), "ros1", "ros1msg"
    text = connection.msgdef.data or reader.typestore.generate_msgdef(connection.msgtype, ros_version=2)[0]
    schema = Schema(name=name, encoding=schema_encoding, data=text.encode())
    return Channel(connection.topic, schema=schema, message_encoding=encoding, context=context)


def wait_for_subscribers(channels: list[Channel]) -> None:
    while not all(channel.has_sinks() for channel in channels):
        time.sleep(0.005)


def replay(reader: AnyReader, channels: dict[int, Channel], args: argparse.Namespace) -> list[str]:
    """Send every message at its time divided by the speed; tells when each was sent."""
    begin_ns = reader.start_time + round(args.begin * 1e9)
    end_ns = reader.start_time + round(args.end * 1e9) if args.end else None
    connections = [c for c in reader.connections if c.id in channels]
    sent = []
    origin = time.monotonic_ns()
    for connection, stamp_ns, data in reader.messages(connections, start=begin_ns, stop=end_ns):
        ahead_ns = origin + (stamp_ns - begin_ns) / args.speed - time.monotonic_ns()
        if ahead_ns > 0:
            time.sleep(ahead_ns * 1e-9)
        sent.append(f"{connection.topic} {time.monotonic_ns()}")
        channels[connection.id].log(bytes(data), log_time=stamp_ns)
    return sent


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("recording", type=Path)
    parser.add_argument("--topics", nargs="+", required=True)
    parser.add_argument("--port", type=int, default=0)
    parser.add_argument("--speed", type=float, default=1.0)
    parser.add_argument("--begin", type=float, default=0.0)
    parser.add_argument("--end", type=float)
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
        wait_for_subscribers(list(channels.values()))
        sent = replay(reader, channels, args)
        if args.stamps:
            args.stamps.write_text("\n".join(sent))
        print("replayed", flush=True)
        while True:
            time.sleep(60.0)


if __name__ == "__main__":
    main()
