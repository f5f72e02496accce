"""Occupancy classes as a PNG of two bits a cell: a palette with transparency, made to be written fast."""

import struct
import zlib
from binascii import crc32

import numpy as np
from numpy.typing import NDArray

from hectorscope.page.theme import Rgb

SIGNATURE = b"\x89PNG\r\n\x1a\n"


def encode(cells: NDArray[np.uint8], palette: tuple[Rgb, ...], alpha: tuple[int, ...]) -> bytes:
    """PNG of `cells` (rows, cols), each the index 0..3 of a colour in `palette` and an opacity in `alpha`."""
    rows, cols = cells.shape
    header = struct.pack(">IIBBBBB", cols, rows, 2, 3, 0, 0, 0)  # two bits, palette, no interlace
    chunks = (
        (b"IHDR", header),
        (b"PLTE", bytes(channel for colour in palette for channel in colour)),
        (b"tRNS", bytes(alpha)),
        (b"IDAT", deflated(packed(cells))),
        (b"IEND", b""),
    )
    return SIGNATURE + b"".join(chunk(kind, content) for kind, content in chunks)


def deflated(lines: bytes) -> bytes:
    """Compressed by its runs alone: of maps smaller than by zlib's search for repetitions, and sooner done."""
    compressor = zlib.compressobj(1, strategy=zlib.Z_RLE)
    return compressor.compress(lines) + compressor.flush()


def packed(cells: NDArray[np.uint8]) -> bytes:
    """Each row as a zero (no filter) and four cells a byte, the first in the highest bits."""
    rows, cols = cells.shape
    width = -(-cols // 4)
    padded = np.zeros((rows, 4 * width), np.uint8)
    padded[:, :cols] = cells
    # One little-endian word: the first cell is its lowest byte. The product has all four in its highest byte.
    products = padded.view("<u4") * np.uint32(1 << 30 | 1 << 20 | 1 << 10 | 1)
    lines = np.zeros((rows, 1 + width), np.uint8)
    lines[:, 1:] = products.view(np.uint8)[:, 3::4]
    return lines.tobytes()


def chunk(kind: bytes, content: bytes) -> bytes:
    """Length, kind, content, checksum."""
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", crc32(content, crc32(kind)))
