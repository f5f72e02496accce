"""Reads an .mcap from front to back: cut files, and those that are not of a ROS 2 recorder."""

from collections.abc import Iterator
from pathlib import Path

from mcap.records import Channel as McapChannel
from mcap.records import Message, Schema
from mcap.stream_reader import StreamReader

from hectorscope.ros.decode import DefinitionFormat, Generation, ros2_name
from hectorscope.sources._recording import Channel, Raw

_FORMS: dict[str, DefinitionFormat] = {"ros1msg": "msg", "ros2msg": "msg", "ros2idl": "idl", "omgidl": "idl"}


def scan_mcap(path: Path) -> Iterator[Raw]:
    """Every message that can still be read, in the order of the file; a chunk that is cut is lost."""
    schemas: dict[int, Schema] = {}
    channels: dict[int, Channel] = {}
    with path.open("rb") as file:
        try:
            for record in StreamReader(file, record_size_limit=path.stat().st_size).records:
                if isinstance(record, Schema):
                    schemas[record.id] = record
                elif isinstance(record, McapChannel):
                    channel = _channel(record, schemas.get(record.schema_id))
                    if channel is not None:
                        channels[record.id] = channel
                elif isinstance(record, Message) and record.channel_id in channels:
                    yield Raw(channels[record.channel_id], record.log_time, record.data)
        except Exception:  # the parser's ways to stumble over a damaged file are many
            return


def _channel(record: McapChannel, schema: Schema | None) -> Channel | None:
    """None for channels in other encodings than those of ROS."""
    if schema is None or record.message_encoding not in ("cdr", "ros1"):
        return None
    form = _FORMS.get(schema.encoding)
    definition = schema.data.decode(errors="replace") if form else ""
    generation: Generation = "ros1" if record.message_encoding == "ros1" else "ros2"
    return Channel(record.topic, ros2_name(schema.name), generation, definition, form or "msg")
