"""Tiles keep what they are given."""

import zlib

import numpy as np
import pytest
from numpy.typing import NDArray

from slam_core.mapping.tiles import TILE, PackedTile, Tile


@pytest.mark.parametrize("surfels", [False, True])
def test_a_packed_tile_is_the_same_and_smaller(surfels: bool) -> None:
    """Every array to the byte, those that are not there included."""
    rng = np.random.default_rng(4)
    log_odds = tuple(rng.choice([0.0, -0.4, 0.9], (TILE >> i, TILE >> i)).astype(np.float32) for i in range(3))
    tile = Tile(7, log_odds, rng.integers(0, 9, (TILE, TILE), np.uint32) if surfels else None)
    packed = PackedTile.of(tile, zlib.compress)
    again = packed.tile(zlib.decompress)
    assert again.revision == packed.revision == 7
    assert contents(again) == contents(tile)
    assert packed.nbytes < tile.nbytes / 4


def contents(tile: Tile) -> list[tuple[str, tuple[int, ...], bytes] | None]:
    """Kind, shape and bytes of every array."""

    def content(array: NDArray[np.generic] | None) -> tuple[str, tuple[int, ...], bytes] | None:
        return None if array is None else (array.dtype.str, array.shape, array.tobytes())

    return [content(array) for array in (*tile.log_odds, tile.surfels)]
