"""The levels of the map as images of classes: unknown, free, occupied."""

import numpy as np
from numpy.typing import NDArray

from hectorscope.run.map_image import MapImage
from slam_core.mapping.pyramid import Pyramid
from slam_core.mapping.tiles import Box, common, part, tiles_around
from slam_core.measurements import Float32s

PAGE = 1 << 23  # cells of a level that the page draws one by one
FILE = 1 << 27  # and a file: 128 MB as an image


def map_images(pyramid: Pyramid, revision: int = 0, most: int = PAGE) -> tuple[MapImage, ...]:
    """The known part of every level, finest first; none before the first map update.

    A level that reaches over more than `most` cells is drawn in pixels of two by two cells, or four by four, and
    so on: `resolution` and x, y are those of the pixels then, and there are no surfels.
    """
    numbers = range(len(pyramid.levels))
    images = (level_image(pyramid, number, revision, most) for number in numbers if not pyramid.empty)
    return tuple(image for image in images if image.cells.size)


def level_image(pyramid: Pyramid, number: int, revision: int = 0, most: int = PAGE) -> MapImage:
    """One of `map_images`; the pyramid must not be empty."""
    row0, row1, column0, column1 = box = pyramid.bounds(number)
    cell, halvings = pyramid.levels[number].resolution, 0
    while ((row1 - row0) >> halvings) * ((column1 - column0) >> halvings) > most:
        halvings += 1
    cells = _reduced(pyramid, number, halvings)
    if halvings:
        row, column, pixel = row0 >> halvings, column0 >> halvings, cell * 2**halvings
        return MapImage(number, pixel, column * pixel, row * pixel, cells, revision)
    x, y = (cell * np.array([column0, row0])).tolist()
    surfels = np.zeros((0, 0), np.uint32) if number else pyramid.gather(0, box, "surfels")
    return MapImage(number, cell, x, y, cells, revision, surfels)


def _reduced(pyramid: Pyramid, number: int, halvings: int) -> NDArray[np.uint8]:
    """A level in pixels of 2^halvings cells on a side, of which the most occupied counts; from tile to tile."""
    bounds = _pixels(pyramid.bounds(number), halvings)
    out = np.zeros((bounds[1] - bounds[0], bounds[3] - bounds[2]), np.uint8)
    for whole, log_odds in pyramid.pieces(number):
        box = common(pyramid.bounds(number), whole)
        pixels, classes = _pixels(box, halvings), _classes(log_odds[part(box, whole)])
        seen = out[part(pixels, bounds)]
        np.maximum(seen, _largest(classes, box, pixels, 1 << halvings), out=seen)
    return out


def _largest(classes: NDArray[np.uint8], box: Box, pixels: Box, n: int) -> NDArray[np.uint8]:
    """The largest class in each of the pixels, of n cells on a side, that a box of cells touches."""
    if n == 1:
        return classes
    rows, columns = pixels[1] - pixels[0], pixels[3] - pixels[2]
    padded = np.zeros((n * rows, n * columns), np.uint8)
    padded[part(box, (n * pixels[0], 0, n * pixels[2], 0))] = classes
    largest: NDArray[np.uint8] = padded.reshape(rows, n, columns, n).max(axis=3).max(axis=1)
    return largest


def _classes(log_odds: Float32s) -> NDArray[np.uint8]:
    """0 unknown, 1 free, 2 occupied."""
    classes: NDArray[np.uint8] = (log_odds != 0).view(np.uint8)
    classes += (log_odds > 0).view(np.uint8)
    return classes


def _pixels(box: Box, halvings: int) -> Box:
    """The pixels that a box of cells touches."""
    return tiles_around(box, 1 << halvings)
