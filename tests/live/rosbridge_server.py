"""Replays a recording as a rosbridge server would: its protocol, with topics from rosapi and messages in CBOR.

Run as a program of its own, so that it can be killed like one:
    python -m tests.live.rosbridge_server RECORDING --topics /scan /imu [--port 9090] [--speed 4]
        [--begin 2] [--late /imu]
It says "listening PORT", waits until somebody has subscribed to every topic, and replays once. A topic that is
late is not listed when topics are asked for the first time.
"""

import argparse
import json
import threading

import cbor2
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.msg import denormalize_msgtype
from websockets.sync.server import ServerConnection, serve

from tests.live.pacing import flags, paced


class Bridge:
    """One recording for one client. types: of each topic, as the robot's ROS names them."""

    def __init__(self, reader: AnyReader, args: argparse.Namespace) -> None:
        self._reader, self._args = reader, args
        names = {c.topic: c.msgtype for c in reader.connections if c.topic in args.topics}
        self.types = names if reader.is2 else {t: denormalize_msgtype(name) for t, name in names.items()}
        self._asked = 0

    def talk(self, connection: ServerConnection) -> None:
        """Answer requests; once everything is subscribed to, replay."""
        missing = set(self.types)
        for text in connection:
            request = json.loads(text)
            if request["op"] == "call_service" and request["service"] == "/rosapi/topics":
                self._asked += 1
                listed = [t for t in self.types if self._asked > 1 or t not in self._args.late]
                values = {"topics": listed, "types": [self.types[t] for t in listed]}
                answer = {"op": "service_response", "service": request["service"], "values": values}
                connection.send(json.dumps(answer | {"id": request["id"], "result": True}))
            elif request["op"] == "subscribe":
                assert request["compression"] == "cbor-raw"
                assert request["type"] == self.types[request["topic"]]
                missing.discard(request["topic"])
                if not missing:
                    threading.Thread(target=self._replay, args=[connection], daemon=True).start()

    def _replay(self, connection: ServerConnection) -> None:
        wanted = [c for c in self._reader.connections if c.topic in self.types]
        for topic, stamp_ns, data in paced(self._reader, wanted, self._args):
            raw = {"secs": stamp_ns // 10**9, "nsecs": stamp_ns % 10**9, "bytes": data}
            connection.send(cbor2.dumps({"op": "publish", "topic": topic.topic, "msg": raw}))


def main() -> None:
    parser = flags()
    parser.add_argument("--late", nargs="+", default=[])
    args = parser.parse_args()
    with AnyReader([args.recording], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
        server = serve(Bridge(reader, args).talk, "127.0.0.1", args.port)
        print(f"listening {server.socket.getsockname()[1]}", flush=True)
        server.serve_forever()


if __name__ == "__main__":
    main()
