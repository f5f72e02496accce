"""Reads an .mcap from front to back: cut files, and those that are not of a ROS 2 recorder."""

from collections.abc import Iterator
from contextlib import suppress
from io import BytesIO
from pathlib import Path

from mcap.records import Channel as McapChannel
from mcap.records import Chunk, McapRecord, Message, Schema
from mcap.stream_reader import StreamReader

from hectorscope.ros.decode import DefinitionFormat, Generation, ros2_name
from hectorscope.sources._recording import Channel, Raw
from hectorscope.sources._unpacking import unpacked

FORMS: dict[str, DefinitionFormat] = {"ros1msg": "msg", "ros2msg": "msg", "ros2idl": "idl", "omgidl": "idl"}


def scan_mcap(path: Path) -> Iterator[Raw]:
    """Every message that can still be read, in the order of the file; a damaged chunk as far as it goes."""
    schemas: dict[int, Schema] = {}
    channels: dict[int, Channel] = {}
    with path.open("rb") as file, suppress(Exception):  # the parser's ways to stumble over a damaged file are many
        for record in records(StreamReader(file, emit_chunks=True, record_size_limit=path.stat().st_size)):
            if isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, McapChannel):
                channel = _channel(record, schemas.get(record.schema_id))
                if channel is not None:
                    channels[record.id] = channel
            elif isinstance(record, Message) and record.channel_id in channels:
                yield Raw(channels[record.channel_id], record.log_time, record.data)


def records(reader: StreamReader) -> Iterator[McapRecord]:
    """Those of the file and those within chunks; what a chunk holds is read one by one."""
    for record in reader.records:
        if not isinstance(record, Chunk):
            yield record
            continue
        with suppress(
            Exception
        ):  # a damaged chunk costs itself; a whole one ends in an error too, having no footer
            content = unpacked(record.compression, record.data, record.uncompressed_size)
            yield from StreamReader(BytesIO(content), skip_magic=True, emit_chunks=True).records


def _channel(record: McapChannel, schema: Schema | None) -> Channel | None:
    """None for channels in other encodings than those of ROS."""
    if schema is None or record.message_encoding not in ("cdr", "ros1"):
        return None
    form = FORMS.get(schema.encoding)
    definition = schema.data.decode(errors="replace") if form else ""
    generation: Generation = "ros1" if record.message_encoding == "ros1" else "ros2"
    return Channel(record.topic, ros2_name(schema.name), generation, definition, form or "msg")
