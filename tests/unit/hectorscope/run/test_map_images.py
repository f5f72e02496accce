"""Pictures of the map: every cell of a small one, and pixels of several cells of a large one."""

import numpy as np
import pytest

from hectorscope.run.map_images import map_images
from slam_core.config import MapConfig
from slam_core.mapping.pyramid import Pyramid

CONFIG = MapConfig(size=64)
NOTHING = np.empty((0, 2), np.float32)


@pytest.fixture(scope="module")
def street() -> Pyramid:
    """A map of 60 m, most of it in tiles outside of the window."""
    pyramid = Pyramid(CONFIG)
    for x in range(0, 60, 2):
        points = np.array([[1.0, 2.0], [1.5, -2.0], [6.0, 0.3]], np.float32)
        pyramid.update(points, NOTHING, np.zeros(2), np.array([x, 0.3 * x, 0.0]), CONFIG)
    assert pyramid.stored > 10
    return pyramid


def test_an_empty_map_has_no_picture():
    """Nothing was seen yet."""
    assert map_images(Pyramid(CONFIG)) == ()


def test_a_picture_has_every_known_cell(street: Pyramid):
    """In the window or outside of it: free and occupied where the log-odds are, at its place."""
    for number, image in enumerate(map_images(street, 7)):
        row0, _, column0, _ = box = street.bounds(number)
        log_odds = street.gather(number, box)
        np.testing.assert_array_equal(image.cells == 2, log_odds > 0)
        np.testing.assert_array_equal(image.cells == 1, log_odds < 0)
        assert (image.x, image.y) == pytest.approx((column0 * image.resolution, row0 * image.resolution))
        assert (image.level, image.revision) == (number, 7)
    np.testing.assert_array_equal(map_images(street)[0].surfels, street.gather(0, street.bounds(), "surfels"))


@pytest.mark.parametrize("most", [200_000, 30_000, 300, 20])
def test_a_large_map_has_pixels_of_several_cells(street: Pyramid, most: int):
    """No picture has many more pixels than asked for; the most occupied cell of each counts; places are true."""
    image, row, column = map_images(street, most=most)[0], *np.nonzero(street.gather(0, street.bounds()) > 0)
    n = round(image.resolution / CONFIG.resolution)
    assert n > 1
    assert image.cells.size < most + 4 * sum(image.cells.shape)
    assert not image.surfels.size
    first = np.rint(np.array([image.y, image.x]) / image.resolution).astype(int)
    seen = np.zeros_like(image.cells)
    seen[(row + street.bounds()[0]) // n - first[0], (column + street.bounds()[2]) // n - first[1]] = 2
    np.testing.assert_array_equal(image.cells == 2, seen == 2)
