"""The share in which two maps differ."""

import math
from dataclasses import replace

import numpy as np

from hectorscope.run.map_difference import share_that_differs
from hectorscope.run.map_images import MapImage

ONE = MapImage(0, 0.05, -0.1, 0.2, np.array([[1, 2], [0, 1]], np.uint8), 0)


def test_a_map_does_not_differ_from_itself() -> None:
    """Nor from one that reaches further, where nothing is known there."""
    wider = np.zeros((4, 5), np.uint8)
    wider[1:3, 2:4] = ONE.cells
    assert share_that_differs(ONE, ONE) == 0.0
    assert share_that_differs(ONE, replace(ONE, cells=wider, x=-0.2, y=0.15)) == 0.0


def test_the_share_is_of_what_one_of_them_knows() -> None:
    """One of three known cells is a wall in the other; a shift by a cell changes what lies over what."""
    other = np.array([[1, 1], [0, 1]], np.uint8)
    assert math.isclose(share_that_differs(ONE, replace(ONE, cells=other)), 1 / 3)
    assert share_that_differs(ONE, replace(ONE, x=ONE.x + 0.05)) == 1.0


def test_cells_of_other_sizes_cannot_be_compared() -> None:
    """There is no number for that; without any known cell nothing differs."""
    assert math.isnan(share_that_differs(ONE, replace(ONE, resolution=0.1)))
    empty = replace(ONE, cells=np.zeros((2, 2), np.uint8))
    assert share_that_differs(empty, empty) == 0.0
