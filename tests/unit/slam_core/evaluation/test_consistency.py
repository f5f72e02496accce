"""The share of beams that agree with a map, on maps of a few cells."""

import numpy as np
import pytest

from slam_core.evaluation.consistency import consistency
from slam_core.measurements import Float64s

CELL = 0.05


def room() -> np.ndarray:
    """A square room of 6 m with the base in its middle; its walls are the outermost cells."""
    cells = np.zeros((120, 120), np.bool_)
    cells[[0, -1]] = cells[:, [0, -1]] = True
    return cells


def beams(length: float, n: int = 72) -> tuple[Float64s, Float64s]:
    """Beams around (0, 0), each as long as the way to the wall times `length`."""
    angles = np.linspace(-np.pi, np.pi, n, endpoint=False)
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    to_wall = 2.975 / np.maximum(*np.abs(directions).T)
    return np.zeros((n, 2)), length * to_wall[:, None] * directions


def score(cells: np.ndarray, begins: Float64s, ends: Float64s) -> float:
    return consistency(cells, np.array([-3.0, -3.0]), CELL, begins, ends)


def test_beams_that_end_on_the_walls_agree():
    """All of them; also those that end a cell beside a wall."""
    assert score(room(), *beams(1.0)) == 1.0
    assert score(room(), *beams(0.985)) == 1.0


@pytest.mark.parametrize("length", [0.5, 1.5])
def test_beams_that_end_elsewhere_do_not(length: float):
    """In free space, or outside of the map."""
    assert score(room(), *beams(length)) == 0.0


def test_beams_through_a_wall_do_not():
    """A second wall before the first, as a map has that was drawn twice: one quarter of the beams crosses it."""
    cells = room()
    cells[20:100, 90] = True
    assert 0.6 < score(cells, *beams(1.0)) < 0.85


def test_the_robot_itself_is_no_wall():
    """Cells within half a metre of the base are passed over."""
    cells = room()
    cells[60, 66] = True
    assert score(cells, *beams(1.0)) == 1.0


def test_nothing_scores_nothing():
    """No beams, or no map, are no agreement."""
    assert score(room(), np.zeros((0, 2)), np.zeros((0, 2))) == 0.0
    assert score(np.zeros((0, 0), np.bool_), *beams(1.0)) == 0.0
