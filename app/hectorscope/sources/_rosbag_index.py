"""Reads the messages of a ROS 1 bag at the places of its index, of which it keeps 16 bytes a message."""

import os
import struct
from collections import defaultdict
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import BinaryIO, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hectorscope.sources._recording import NOTHING, Channel, Passed, Raw
from hectorscope.sources._rosbag_scan import (
    CHUNK,
    CONNECTION,
    TIME,
    U32,
    Fields,
    channel_of,
    fields_of,
    read_sized,
)
from hectorscope.sources._unpacking import unpacked

_HEADER, _INDEX, _CHUNK_INFO = b"\x03", b"\x04", b"\x06"
_IS_MESSAGE, _IS_CONNECTION = b"\x04\x00\x00\x00op=\x02", b"\x04\x00\x00\x00op=\x07"
_U64 = struct.Struct("<Q")
_TOGETHER = 4096  # places that are taken from the index at once
_ENTRY = np.dtype([("sec", "<u4"), ("nsec", "<u4"), ("offset", "<u4")])
_PLACE = np.dtype([("time_ns", "<i8"), ("chunk", "<u4"), ("offset", "<u4")])

Places = NDArray[np.void]


class _Chunk(NamedTuple):
    """Where a chunk's data lie in the file."""

    compression: str
    begin: int
    size: int


class BagIndex:
    """The index of a bag. Errors of many kinds where it is damaged or missing.

    connections: the channel of each and where its messages are, by time; several may be of one channel.
    span_ns: times of the first and the last message.
    """

    def __init__(self, path: Path) -> None:
        self.connections: list[tuple[Channel, Places]] = []
        self.span_ns = (0, 0)
        self._path = path
        self._chunks: list[_Chunk] = []
        self._rest = path.stat().st_size  # bytes that the entries can have at most
        with path.open("rb") as file:
            try:
                self._read_file(file)
            except (KeyError, struct.error) as error:
                raise ValueError("its index is damaged") from error

    def _read_file(self, file: BinaryIO) -> None:
        file.readline()
        fields = _expect(file, _HEADER, behind=True)
        connections, chunks = (U32.unpack(fields[name])[0] for name in (b"conn_count", b"chunk_count"))
        (begin,) = _U64.unpack(fields[b"index_pos"])
        if begin == 0:
            raise ValueError("it has no index")
        if fields.get(b"encryptor"):
            raise ValueError("it is encrypted")
        if chunks:
            file.seek(begin)
            self._read_index(file, connections, chunks)

    def _read_index(self, file: BinaryIO, connections: int, chunks: int) -> None:
        channels: dict[int, Channel] = {}
        for _ in range(connections):
            fields = _expect(file, CONNECTION)
            channels[U32.unpack(fields[b"conn"])[0]] = channel_of(fields, read_sized(file))
        infos = [_expect(file, _CHUNK_INFO, behind=True) for _ in range(chunks)]
        full = [fields for fields in infos if any(fields[b"count"])]
        times = [TIME.unpack(fields[name]) for fields in full for name in (b"start_time", b"end_time")]
        times_ns = [seconds * 10**9 + nanoseconds for seconds, nanoseconds in times]
        self.span_ns = min(times_ns, default=0), max(times_ns, default=0)
        parts: defaultdict[int, list[Places]] = defaultdict(list)
        for fields in full:
            file.seek(_U64.unpack(fields[b"chunk_pos"])[0])
            self._read_chunk(file, U32.unpack(fields[b"count"])[0], parts)
        self.connections = [(channel, _by_time(parts.get(number, []))) for number, channel in channels.items()]

    def _read_chunk(self, file: BinaryIO, indexes: int, parts: dict[int, list[Places]]) -> None:
        """Where a chunk is, and the entries of the index behind it, one record for each connection."""
        compression = _expect(file, CHUNK)[b"compression"].decode()
        if compression not in ("none", "bz2", "lz4"):
            raise ValueError(f"its compression {compression!r} is not known")
        (size,) = U32.unpack(file.read(U32.size))
        number = len(self._chunks)
        self._chunks.append(_Chunk(compression, file.tell(), size))
        file.seek(size, os.SEEK_CUR)
        for _ in range(indexes):
            connection = U32.unpack(_expect(file, _INDEX)[b"conn"])[0]
            parts[connection].append(self._entries(read_sized(file), number))

    def _entries(self, data: bytes, chunk: int) -> Places:
        self._rest -= len(data)
        if self._rest < 0:
            raise ValueError("its index has more entries than there is room for in the file")
        entries = np.frombuffer(data, _ENTRY)
        places = np.empty(len(entries), _PLACE)
        places["time_ns"] = entries["sec"] * np.int64(10**9) + entries["nsec"]
        places["chunk"], places["offset"] = chunk, entries["offset"]
        return places

    def messages(self, channels: Collection[Channel], passed: Passed = NOTHING) -> Iterator[Raw]:
        """The messages of some channels, by time, behind those passed; ValueError where there is no message."""
        with self._path.open("rb") as file:
            content, chunk = b"", -1
            for channel, time_ns, number, offset in self._in_order(channels, passed.read.total()):
                if number != chunk:
                    content, chunk = _unpacked(file, self._chunks[number]), number
                yield Raw(channel, time_ns, _content(content, offset))

    def _in_order(self, channels: Collection[Channel], skip: int) -> Iterator[tuple[Channel, int, int, int]]:
        """Channel, time, chunk and offset of messages by time; at one time those of the first connection first."""
        wanted = [connection for connection in self.connections if connection[0] in channels]
        places = np.concatenate([np.empty(0, _PLACE), *(places for _, places in wanted)])
        owners = np.repeat(np.arange(len(wanted)), [len(places) for _, places in wanted])
        order = np.argsort(places["time_ns"], kind="stable")
        for begin in range(skip, len(order), _TOGETHER):
            some = order[begin : begin + _TOGETHER]
            for owner, place in zip(owners[some].tolist(), places[some].tolist(), strict=True):
                yield wanted[owner][0], *place


def _by_time(parts: list[Places]) -> Places:
    """The entries of one connection in one."""
    places = np.concatenate([np.empty(0, _PLACE), *parts])
    return places[np.argsort(places["time_ns"], kind="stable")]


def _expect(file: BinaryIO, kind: bytes, *, behind: bool = False) -> Fields:
    """The header of the record that begins here. behind: leave the file behind its data."""
    fields = fields_of(read_sized(file))
    if fields.get(b"op") != kind:
        raise ValueError("its index is damaged")
    if behind:
        read_sized(file)
    return fields


def _unpacked(file: BinaryIO, chunk: _Chunk) -> bytes:
    """What a chunk holds."""
    file.seek(chunk.begin)
    return unpacked(chunk.compression, file.read(chunk.size))


def _content(chunk: bytes, position: int) -> bytes:
    """The data of the message record that begins here, or behind the descriptions of connections."""
    while True:
        try:
            begin = position + U32.size + U32.unpack_from(chunk, position)[0]
            end = begin + U32.size + U32.unpack_from(chunk, begin)[0]
        except struct.error as error:
            raise ValueError("a message reaches beyond the end of its chunk") from error
        if end > len(chunk):
            raise ValueError("a message reaches beyond the end of its chunk")
        if chunk.find(_IS_MESSAGE, position, begin) >= 0:
            return chunk[begin + U32.size : end]
        if chunk.find(_IS_CONNECTION, position, begin) < 0:
            raise ValueError("there is no message where the index has one")
        position = end
