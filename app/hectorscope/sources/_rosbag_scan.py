"""Reads a ROS 1 bag from front to back, for files whose index is missing: cut off, or never closed."""

import bz2
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

import lz4.frame

from hectorscope.ros.decode import ros2_name
from hectorscope.sources._recording import Channel, Raw

_MESSAGE, _CHUNK, _CONNECTION = b"\x02", b"\x05", b"\x07"
LARGEST_CHUNK = 2**28  # bytes; recorders write chunks of 0.75 MB by default, and some MB at most
_U32 = struct.Struct("<I")
_TIME = struct.Struct("<II")

_Fields = dict[bytes, bytes]


class _CutOff(Exception):
    """The data end inside a record."""


def scan_rosbag(path: Path) -> Iterator[Raw]:
    """Every message that can still be read, in the order of the file; the cut chunk as far as it goes."""
    connections: dict[bytes, Channel] = {}
    with path.open("rb") as file:
        file.readline()
        for fields, data in _records(file, path.stat().st_size):
            if fields.get(b"op") == _CHUNK:
                yield from _messages(_inflate(fields.get(b"compression", b"none"), data), connections)


def _messages(chunk: bytes, connections: dict[bytes, Channel]) -> Iterator[Raw]:
    """The messages of a chunk, without broken records; connections that it describes are added to those known."""
    for fields, content in _inner_records(chunk):
        try:
            number = fields[b"conn"]
            if fields[b"op"] == _CONNECTION:
                connections[number] = _channel(fields, content)
            elif fields[b"op"] == _MESSAGE and number in connections:
                seconds, nanoseconds = _TIME.unpack(fields[b"time"])
                yield Raw(connections[number], seconds * 1_000_000_000 + nanoseconds, content)
        except (_CutOff, KeyError, struct.error):
            continue


def _records(file: BinaryIO, file_size: int) -> Iterator[tuple[_Fields, bytes]]:
    """Records of the file: (header fields, data); the last one may be cut."""
    while len(head := file.read(_U32.size)) == _U32.size:
        header = file.read(min(_U32.unpack(head)[0], file_size))
        size = file.read(_U32.size)
        if len(size) < _U32.size:
            return
        try:
            yield _fields(header), file.read(min(_U32.unpack(size)[0], file_size))
        except _CutOff:
            return


def _inner_records(chunk: bytes) -> Iterator[tuple[_Fields, bytes]]:
    """Whole records of a chunk's content."""
    position = 0
    try:
        while position < len(chunk):
            header, position = _sized(chunk, position)
            content, position = _sized(chunk, position)
            yield _fields(header), content
    except _CutOff:
        return


def _sized(data: bytes, position: int) -> tuple[bytes, int]:
    """A length and that many bytes, and the position behind them."""
    begin = position + _U32.size
    if begin > len(data):
        raise _CutOff
    end = begin + _U32.unpack_from(data, position)[0]
    if end > len(data):
        raise _CutOff
    return data[begin:end], end


def _fields(header: bytes) -> _Fields:
    fields: _Fields = {}
    position = 0
    while position < len(header):
        field, position = _sized(header, position)
        name, _, value = field.partition(b"=")
        fields[name] = value
    return fields


def _channel(fields: _Fields, content: bytes) -> Channel:
    described = _fields(content)
    return Channel(
        fields[b"topic"].decode(errors="replace"),
        ros2_name(described[b"type"].decode(errors="replace")),
        "ros1",
        described.get(b"message_definition", b"").decode(errors="replace"),
    )


def _inflate(compression: bytes, data: bytes) -> bytes:
    """The content of a chunk, as much of it as is there."""
    try:
        return unpacked(compression, data)
    except (OSError, RuntimeError, EOFError):
        return b""


def unpacked(compression: bytes, data: bytes) -> bytes:
    """The content of a chunk, LARGEST_CHUNK bytes of it at most; the library's errors for what is none."""
    if compression == b"bz2":
        return bz2.BZ2Decompressor().decompress(data, LARGEST_CHUNK)
    if compression == b"lz4":
        content: bytes = lz4.frame.LZ4FrameDecompressor().decompress(data, LARGEST_CHUNK)
        return content
    return data
