"""A map as it was at one moment, in tiles that it shares with the moments before."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from slam_core.mapping.grid import GridLevel
from slam_core.mapping.tiled_map import TiledMap
from slam_core.mapping.tiles import Key, PackedTile, Tile


class Packing(NamedTuple):
    """How tiles are packed, without loss, and unpacked; on any thread."""

    pack: Callable[[bytes], bytes]
    unpack: Callable[[bytes], bytes]


class FrozenMap:
    """Everything that a map is; never written.

    before: the same map frozen earlier, with no other change between than later ones: tiles that did not change
    since are shared with it.
    """

    def __init__(self, tiled: TiledMap, packing: Packing, before: "FrozenMap | None" = None) -> None:
        self._packing = packing
        self._rest, self._outside = tiled.with_parts((), {}), tiled.outside
        self._levels = [(*_frame(level), level.bounds, level.revisions.copy()) for level in tiled.levels]
        self._window: dict[Key, PackedTile] = {}
        revisions = tiled.revisions()
        row, _, column, _ = tiled.window
        for y, x in np.argwhere(revisions > 0).tolist():
            key, revision = (column + x, row + y), int(revisions[y, x])
            kept = before.packed(key) if before else None
            if kept is None or kept.revision != revision:
                kept = PackedTile.of(tiled.taken(key, revision), packing.pack)
            self._window[key] = kept

    def packed(self, key: Key) -> PackedTile | None:
        """A tile of the window; None if nothing was seen there."""
        return self._window.get(key)

    def tile(self, key: Key) -> Tile | None:
        """A tile; None if nothing was seen there."""
        packed = self._window.get(key)
        return packed.tile(self._packing.unpack) if packed else self._outside.get(key)

    @property
    def tiles(self) -> list[PackedTile | Tile]:
        """All of them, as they are kept."""
        return [*self._window.values(), *self._outside.values()]

    def thaw(self) -> Any:
        """A map that goes on from here, of the class of the frozen one."""
        window = {key: packed.tile(self._packing.unpack) for key, packed in self._window.items()}
        levels = tuple(self._level(i, window) for i in range(len(self._levels)))
        return self._rest.with_parts(levels, self._outside)

    def _level(self, i: int, window: dict[Key, Tile]) -> GridLevel:
        resolution, shape, corner, tile, bounds, revisions = self._levels[i]
        level = GridLevel(resolution, shape, resolution * corner, surfels=i == 0, tile=tile)
        for key, kept in window.items():
            level.put(key, kept.log_odds[i], None if i else kept.surfels, kept.revision)
        level.bounds, level.revisions = bounds, revisions.copy()
        return level


def _frame(level: GridLevel) -> tuple[float, tuple[int, int], Any, int]:
    return level.resolution, level.shape, level.corner.copy(), level.tile
