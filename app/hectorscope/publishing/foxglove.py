"""A server for Foxglove, Lichtblick and our own live input: the Foxglove WebSocket protocol."""

import ipaddress
import re
from typing import Any

from hectorscope.publishing import BusKind, PublishError
from hectorscope.results.topics import TOPICS, Message, definition

FORM = "ws://127.0.0.1:PORT"
ADDRESS = re.compile(r"ws://(?P<host>[^/:\[\]]+|\[[0-9A-Fa-f:.]+\]):(?P<port>\d{1,5})/?")
BACKLOG = 64  # messages that a slow client may be behind; then the oldest are lost


class FoxgloveBus:
    """Serves every topic. The protocol knows no token, so it is for this machine alone."""

    def __init__(self, uri: str) -> None:
        """PublishError for an address of another form or of the network, a used port, or without the library."""
        host, port = _address(uri)
        try:
            import foxglove  # noqa: PLC0415 - of the extra `publish`
        except ImportError as error:
            raise PublishError(f"{uri} needs foxglove-sdk: install hectorscope[publish]") from error
        context = self._context = foxglove.Context()  # its channels go with it
        self._channels: dict[str, Any] = {
            topic: foxglove.Channel(
                topic,
                schema=foxglove.Schema(name=msgtype, encoding="ros2msg", data=definition(topic).encode()),
                message_encoding="cdr",
                context=context,
            )
            for topic, msgtype in TOPICS.items()
        }
        try:
            self._server = foxglove.start_server(
                name="hectorscope", host=host, port=port, context=context, message_backlog_size=BACKLOG
            )
        except RuntimeError as error:
            raise PublishError(f"{uri} cannot be served ({error}): choose another port") from error

    def wants(self, topic: str) -> bool:
        """Whether a client has subscribed to it."""
        return bool(self._channels[topic].has_sinks())

    def publish(self, message: Message) -> None:
        """To the clients that have subscribed."""
        if self.wants(message.topic):
            self._channels[message.topic].log(message.content, log_time=message.stamp_ns)

    def close(self) -> None:
        """End the server."""
        self._server.stop()


def _address(uri: str) -> tuple[str, int]:
    found = ADDRESS.fullmatch(uri)
    if found is None or int(found["port"]) > 65535:
        raise PublishError(f"{uri} is no address to serve: give {FORM}, such as ws://127.0.0.1:8766")
    host = found["host"].strip("[]")
    try:
        is_ours = host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        is_ours = False
    if not is_ours:
        raise PublishError(
            f"{uri} would be open to the network, and the protocol knows no token: serve 127.0.0.1, and let"
            " others in by an SSH tunnel or a reverse proxy that asks who they are"
        )
    return ("127.0.0.1" if host == "localhost" else host), int(found["port"])


BUS = BusKind(FORM, FoxgloveBus)
