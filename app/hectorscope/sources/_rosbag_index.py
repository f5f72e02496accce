"""Reads the messages of a ROS 1 bag at the places of its index, without taking every record to pieces."""

import struct
from collections.abc import Collection, Iterator
from itertools import chain, repeat
from typing import BinaryIO

from rosbags.interfaces import Connection
from rosbags.rosbag1 import Reader, ReaderError
from rosbags.rosbag1.reader import Chunk, decompressors

from hectorscope.sources._rosbag_scan import unpacked

# The library unpacks a chunk whatever becomes of it.
_COMPRESSIONS = {decompressors["bz2"]: b"bz2", decompressors["lz4"]: b"lz4"}
_SIZE = struct.Struct("<I")
_IS_MESSAGE, _IS_CONNECTION = b"\x04\x00\x00\x00op=\x02", b"\x04\x00\x00\x00op=\x07"


class BagIndex:
    """The index of a bag, taken over from an open reader."""

    def __init__(self, reader: Reader) -> None:
        self.connections = reader.connections.copy()
        self._path = reader.path
        self._entries, self._chunks = reader.indexes.copy(), reader.chunks.copy()

    def messages(self, connections: Collection[Connection]) -> Iterator[tuple[Connection, int, bytes]]:
        """Connection, time and content of the messages of some connections, by time.

        ReaderError where there is no message.
        """
        entries = chain.from_iterable(zip(self._entries[c.id], repeat(c), strict=False) for c in connections)
        with self._path.open("rb") as file:
            chunk, chunk_pos = b"", -1
            for entry, connection in sorted(entries, key=lambda pair: pair[0].time):
                if entry.chunk_pos != chunk_pos:
                    chunk, chunk_pos = _unpacked(file, self._chunks[entry.chunk_pos]), entry.chunk_pos
                yield connection, entry.time, _content(chunk, entry.offset)


def _unpacked(file: BinaryIO, chunk: Chunk) -> bytes:
    """What a chunk holds."""
    file.seek(chunk.datapos)
    return unpacked(_COMPRESSIONS.get(chunk.decompressor, b"none"), file.read(chunk.datasize))


def _content(chunk: bytes, position: int) -> bytes:
    """The data of the message record that begins here, or behind the descriptions of connections."""
    while True:
        try:
            begin = position + _SIZE.size + _SIZE.unpack_from(chunk, position)[0]
            end = begin + _SIZE.size + _SIZE.unpack_from(chunk, begin)[0]
        except struct.error as error:
            raise ReaderError("a message reaches beyond the end of its chunk") from error
        if end > len(chunk):
            raise ReaderError("a message reaches beyond the end of its chunk")
        if chunk.find(_IS_MESSAGE, position, begin) >= 0:
            return chunk[begin + _SIZE.size : end]
        if chunk.find(_IS_CONNECTION, position, begin) < 0:
            raise ReaderError("there is no message where the index has one")
        position = end
