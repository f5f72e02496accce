"""Unpacks chunks, messages and files up to a limit: a small file may hold zeros without end."""

import bz2
import tempfile
from collections.abc import Iterable
from itertools import accumulate
from pathlib import Path
from typing import TYPE_CHECKING

import lz4.frame
import zstandard

from hectorscope.inputs import SourceError

if TYPE_CHECKING:
    from rosbags.rosbag2.storage_mcap import ChunkInfo

LARGEST_CHUNK = 2**27  # bytes; recorders write chunks of 0.75 MB by default, and some MB at most
LARGEST_AT_ONCE = 2**29  # bytes of chunks whose times overlap: they are unpacked together, to be sorted
LARGEST_RATIO = 200  # of a packed file; recordings come to 20 at most
SMALL_FILE = 2**28  # bytes: up to here a file may have any ratio
BLOCK = 2**20


def unpacked(compression: str, data: bytes | memoryview, size: int | None = None) -> bytes:
    """The content of a chunk or message, LARGEST_CHUNK bytes of it at most.

    size: what the file says, if it does; more is left out, and all of it if it says more than the limit. Another
    compression than bz2, lz4 and zstd: the data. OSError, RuntimeError or EOFError for what is none.
    """
    most = LARGEST_CHUNK if size is None else size if size <= LARGEST_CHUNK else 0
    if most == 0:
        return b""
    if compression == "bz2":
        return bz2.BZ2Decompressor().decompress(data, most)
    if compression == "lz4":
        content: bytes = lz4.frame.LZ4FrameDecompressor().decompress(data, most)
        return content
    return _read_zstd(data, most) if compression == "zstd" else bytes(data)


def _read_zstd(data: bytes | memoryview, most: int) -> bytes:
    try:
        with zstandard.ZstdDecompressor().stream_reader(data) as stream:
            blocks = bytearray()
            while len(blocks) < most and (block := stream.read(min(BLOCK, most - len(blocks)))):
                blocks += block
            return bytes(blocks)
    except zstandard.ZstdError as error:
        raise RuntimeError(f"no zstd data ({error})") from error


def check_overlap(chunks: "Iterable[ChunkInfo]") -> None:
    """ValueError if more would be unpacked at once than there should be."""
    edges = [edge for chunk in chunks for edge in _edges(chunk)]
    most = max(accumulate(size for _, size in sorted(edges)), default=0)
    if most > LARGEST_AT_ONCE:
        raise ValueError(f"its chunks of one time unpack to {most / 1e6:.0f} MB")


def _edges(chunk: "ChunkInfo") -> tuple[tuple[int, int], tuple[int, int]]:
    """When a chunk is unpacked and when it is let go, with the bytes more and less."""
    size = min(chunk.uncompressed_size, LARGEST_CHUNK)
    return (chunk.message_start_time, size), (chunk.message_end_time + 1, -size)


def temporary_folder() -> tempfile.TemporaryDirectory[str]:
    """A folder for unpacked files; SourceError if there is no room for any."""
    try:
        return tempfile.TemporaryDirectory(prefix="hectorscope-")
    except OSError as error:
        raise SourceError(
            f"there is no folder for unpacked files ({error.strerror}): set TMPDIR to one"
        ) from error


def unpack_file(packed: Path, target: Path) -> None:
    """Unpack a file; SourceError if it is no zstd, unpacks to more than recordings do, or finds no room."""
    most = max(SMALL_FILE, LARGEST_RATIO * packed.stat().st_size)
    size = 0
    try:
        with (
            packed.open("rb") as file,
            zstandard.ZstdDecompressor().stream_reader(file, read_across_frames=True) as stream,
            target.open("wb") as unpacked_file,
        ):
            while block := stream.read(BLOCK):
                size += unpacked_file.write(block)
                if size > most:
                    raise SourceError(
                        f"{packed} unpacks to over {most / 1e6:.0f} MB, which no recording does: record it again"
                    )
    except zstandard.ZstdError as error:
        raise SourceError(f"{packed} is damaged ({error}): record it again") from error
    except OSError as error:
        raise SourceError(
            f"{packed} cannot be unpacked in {target.parent} ({error.strerror}): make room there, or set TMPDIR to"
            " another folder"
        ) from error
