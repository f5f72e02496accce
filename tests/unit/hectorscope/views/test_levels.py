"""How the images of levels grow, and where their walls are."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from hectorscope.page.scene import Scene
from hectorscope.run.map_image import MapImage
from hectorscope.views._levels import bulk
from hectorscope.views.levels import BLOCK, LevelsView, aligned
from tests.page import RESOLUTION, room_snapshot


@given(st.integers(-300, 300), st.integers(-300, 300), st.integers(1, 150), st.integers(1, 150), st.integers(0, 2))
def test_images_grow_by_whole_blocks(column: int, row: int, rows: int, cols: int, level: int) -> None:
    """The padded image holds the same cells at the same place, and begins and ends on block borders."""
    resolution = 0.05 * 2**level
    cells = np.random.default_rng(0).integers(0, 3, (rows, cols)).astype(np.uint8)
    padded, x, y = aligned(MapImage(level, resolution, column * resolution, row * resolution, cells, 1))
    block = BLOCK >> level
    i, j = round(row - y / resolution), round(column - x / resolution)
    assert np.array_equal(padded[i : i + rows, j : j + cols], cells)
    assert padded.sum() == cells.sum()
    assert [n % block for n in (*padded.shape, round(x / resolution), round(y / resolution))] == [0, 0, 0, 0]


def test_strays_do_not_widen_the_bulk() -> None:
    """One wall cell far out leaves the box around the walls as it is."""
    cells = np.zeros((400, 400), np.uint8)
    cells[100:200, 100], cells[100:200, 199] = 2, 2
    cells[100, 100:200], cells[199, 100:200] = 2, 2
    cells[390, 390] = 2
    low, high = bulk(MapImage(0, RESOLUTION, 0.0, 0.0, cells, 1))
    assert np.all(np.abs(low - 100 * RESOLUTION) <= 4 * RESOLUTION)
    assert np.all(np.abs(high - 200 * RESOLUTION) <= 4 * RESOLUTION)


def test_a_map_without_walls_has_a_bulk() -> None:
    """Free space alone is framed too."""
    low, high = bulk(MapImage(0, 1.0, -2.0, -3.0, np.ones((6, 4), np.uint8), 1))
    assert (low.tolist(), high.tolist()) == ([-2.0, -3.0], [2.0, 3.0])


def test_the_floor_lies_below_what_is_driven(scene: Scene) -> None:
    """Also where all of it lies in one plane: at the same height the map would hide stretches of the path."""
    LevelsView(scene).draw(room_snapshot())
    assert scene.floor.position[2] < room_snapshot().trajectory[:, 3].min()
