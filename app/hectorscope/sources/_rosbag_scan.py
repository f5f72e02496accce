"""Reads a ROS 1 bag from front to back, for files whose index is missing: cut off, or never closed."""

import os
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from hectorscope.ros.decode import ros2_name
from hectorscope.sources._recording import Channel, Raw
from hectorscope.sources._unpacking import unpacked

MESSAGE, CHUNK, CONNECTION = b"\x02", b"\x05", b"\x07"  # kinds of records
U32 = struct.Struct("<I")
TIME = struct.Struct("<II")

Fields = dict[bytes, bytes]


class CutOff(Exception):
    """The data end inside a record."""


def scan_rosbag(path: Path) -> Iterator[Raw]:
    """Every message that can still be read, in the order of the file; the cut chunk as far as it goes."""
    connections: dict[bytes, Channel] = {}
    with path.open("rb") as file:
        file.readline()
        for fields, data in _records(file, path.stat().st_size):
            if fields.get(b"op") == CHUNK:
                yield from _messages(_inflate(fields.get(b"compression", b"none"), data), connections)


def _messages(chunk: bytes, connections: dict[bytes, Channel]) -> Iterator[Raw]:
    """The messages of a chunk, without broken records; connections that it describes are added to those known."""
    for fields, content in _inner_records(chunk):
        try:
            number = fields[b"conn"]
            if fields[b"op"] == CONNECTION:
                connections[number] = channel_of(fields, content)
            elif fields[b"op"] == MESSAGE and number in connections:
                seconds, nanoseconds = TIME.unpack(fields[b"time"])
                yield Raw(connections[number], seconds * 1_000_000_000 + nanoseconds, content)
        except (CutOff, KeyError, struct.error):
            continue


def _records(file: BinaryIO, file_size: int) -> Iterator[tuple[Fields, bytes]]:
    """Records of the file: (header fields, data); the last one may be cut."""
    while len(head := file.read(U32.size)) == U32.size:
        header = file.read(min(U32.unpack(head)[0], file_size))
        size = file.read(U32.size)
        if len(size) < U32.size:
            return
        try:
            yield fields_of(header), file.read(min(U32.unpack(size)[0], file_size))
        except CutOff:
            return


def _inner_records(chunk: bytes) -> Iterator[tuple[Fields, bytes]]:
    """Whole records of a chunk's content."""
    position = 0
    try:
        while position < len(chunk):
            header, position = _sized(chunk, position)
            content, position = _sized(chunk, position)
            yield fields_of(header), content
    except CutOff:
        return


def read_sized(file: BinaryIO) -> bytes:
    """A length and that many bytes; CutOff if there are fewer."""
    head = file.read(U32.size)
    if len(head) < U32.size:
        raise CutOff("it is cut off")
    (size,) = U32.unpack(head)
    if size > os.fstat(file.fileno()).st_size or len(data := file.read(size)) < size:
        raise CutOff("it is cut off")
    return data


def _sized(data: bytes, position: int) -> tuple[bytes, int]:
    """A length and that many bytes, and the position behind them."""
    begin = position + U32.size
    if begin > len(data):
        raise CutOff
    end = begin + U32.unpack_from(data, position)[0]
    if end > len(data):
        raise CutOff
    return data[begin:end], end


def fields_of(header: bytes) -> Fields:
    """The fields of a header by name; CutOff where one is longer than the rest."""
    fields: Fields = {}
    position = 0
    while position < len(header):
        field, position = _sized(header, position)
        name, _, value = field.partition(b"=")
        fields[name] = value
    return fields


def channel_of(fields: Fields, content: bytes) -> Channel:
    """What a record of a connection describes; KeyError where it leaves out something."""
    described = fields_of(content)
    topic = fields[b"topic"].decode(errors="replace")
    return Channel(
        "/" * topic.startswith("/") + "/".join(filter(None, topic.split("/"))),
        ros2_name(described[b"type"].decode(errors="replace")),
        "ros1",
        described.get(b"message_definition", b"").decode(errors="replace"),
    )


def _inflate(compression: bytes, data: bytes) -> bytes:
    """The content of a chunk, as much of it as is there."""
    try:
        return unpacked(compression.decode(errors="replace"), data)
    except (OSError, RuntimeError, EOFError):
        return b""
