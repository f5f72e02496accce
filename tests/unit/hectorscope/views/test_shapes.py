"""Unit shapes and how covariances scale them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hectorscope.views._shapes import disc, ellipse, ellipsoid, prism, ring
from slam_core.geometry import rotation_matrix

SIGMAS = 3.0
seeds = st.integers(0, 2**32 - 1)


def covariance(seed: int, size: int) -> np.ndarray:
    root = np.random.default_rng(seed).normal(size=(size, size))
    return root @ root.T + 0.05 * np.eye(size)


@given(seeds)
def test_the_ellipse_is_the_level_set_of_its_covariance(seed: int) -> None:
    """Every point of the scaled and turned circle has a Mahalanobis distance of the asked sigmas."""
    P = covariance(seed, 2)
    scale, turn = ellipse(P, SIGMAS)
    points = (ring()[:, 0] * scale @ rotation_matrix(turn).T)[:, :2]
    distances = np.sqrt(np.einsum("ni,ij,nj->n", points, np.linalg.inv(P), points))
    assert distances == pytest.approx(SIGMAS, rel=1e-4)


@given(seeds)
def test_the_ellipsoid_is_the_level_set_of_its_covariance(seed: int) -> None:
    """The same in space: along random directions of the unit sphere."""
    P = covariance(seed, 3)
    scale, turn = ellipsoid(P, SIGMAS)
    sphere = np.random.default_rng(seed).normal(size=(50, 3))
    sphere /= np.linalg.norm(sphere, axis=1, keepdims=True)
    points = sphere * scale @ rotation_matrix(turn).T
    distances = np.sqrt(np.einsum("ni,ij,nj->n", points, np.linalg.inv(P), points))
    assert distances == pytest.approx(SIGMAS, rel=1e-6)


def test_a_covariance_of_zero_can_be_drawn() -> None:
    """Certainty is a tiny ellipse, not one of no size, which a browser cannot invert."""
    assert min(ellipse(np.zeros((2, 2)), 50.0)[0]) > 0.0
    assert min(ellipsoid(np.zeros((3, 3)), 50.0)[0]) > 0.0


def volume(vertices: np.ndarray, faces: np.ndarray) -> float:
    a, b, c = vertices[faces].astype(float).transpose(1, 0, 2)
    return float(np.einsum("ni,ni->n", a, np.cross(b, c)).sum() / 6.0)


def test_a_prism_is_closed_and_faces_outwards() -> None:
    """Its signed volume is base times height: no face is missing or inside out."""
    outline = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
    assert volume(*prism(outline, -1.0, 2.0)) == pytest.approx(6.0)


def test_disc_and_ring_fit() -> None:
    """The disc's rim is the ring."""
    assert np.array_equal(disc()[0][1:], ring()[:, 0])
