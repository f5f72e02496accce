import math

import numpy as np
import pytest

from slam_core.navigation import chi_square


@pytest.mark.parametrize(
    ("probability", "dimension", "expected"),
    [(0.05, 1, 3.841459), (0.05, 2, 5.991465), (0.05, 3, 7.814728), (0.01, 6, 16.811894), (0.025, 15, 27.488393)],
)
def test_quantiles_are_those_of_the_tables(probability: float, dimension: int, expected: float) -> None:
    """The printed values of the chi-square distribution to six digits, and the tail gives the probability back."""
    assert chi_square.quantile(probability, dimension) == pytest.approx(expected, abs=1e-6)
    assert chi_square.tail(expected, dimension) == pytest.approx(probability, rel=1e-6)


def test_the_tail_is_the_share_of_random_vectors_beyond() -> None:
    """Half a million normal vectors of four dimensions."""
    squares = np.sum(np.random.default_rng(1).normal(size=(500_000, 4)) ** 2, axis=1)
    assert chi_square.tail(5.0, 4) == pytest.approx(np.mean(squares > 5.0), abs=0.003)
    assert chi_square.tail(0.0, 4) == 1.0


def test_a_gate_means_the_same_in_every_dimension() -> None:
    """In one dimension the bound is the square; in more it leaves out as many good ones; 0 is open."""
    assert chi_square.bound(3.0, 1) == pytest.approx(9.0)
    for dimension in (2, 3):
        left_out = chi_square.tail(chi_square.bound(3.0, dimension), dimension)
        assert left_out == pytest.approx(math.erfc(3.0 / math.sqrt(2.0)))
    assert chi_square.bound(0.0, 3) == math.inf


@pytest.mark.parametrize("gate", [30.0, 100.0])
def test_a_gate_far_out_is_still_a_gate(gate: float) -> None:
    """Where the probability is below what a float holds, the bound is finite and at least the square."""
    assert gate**2 <= chi_square.bound(gate, 3) < 2 * gate**2
