"""The direction of the surface that each beam hit."""

import numpy as np

from slam_core.surfaces import Beams


def test_points_on_a_line_point_along_it():
    """Every endpoint of a straight wall has its direction, up to sign, at full length."""
    t = np.linspace(0, 3, 60)
    points = np.column_stack([1 + t * np.cos(0.6), 2 + t * np.sin(0.6)]).astype(np.float32)
    beams = Beams.with_surfaces(points)
    along = beams.along_x * np.cos(0.6) + beams.along_y * np.sin(0.6)
    np.testing.assert_allclose(np.abs(along), 1.0, atol=1e-3)


def test_every_direction_is_found():
    """The closed form is right in all quadrants, along the axes too."""
    for angle in np.linspace(-np.pi / 2, np.pi / 2, 37):
        t = np.linspace(-1, 1, 40)
        points = np.column_stack([t * np.cos(angle), t * np.sin(angle)]).astype(np.float32)
        beams = Beams.with_surfaces(points)
        np.testing.assert_allclose(
            np.abs(beams.along_x * np.cos(angle) + beams.along_y * np.sin(angle)), 1, atol=1e-3
        )


def test_lone_points_and_blobs_have_no_surface():
    """Endpoints far from their neighbours, and round scatters, keep the whole gradient."""
    rng = np.random.default_rng(0)
    lone = rng.uniform(-20, 20, (50, 2)).astype(np.float32)
    beams = Beams.with_surfaces(lone)
    assert np.hypot(beams.along_x, beams.along_y).max() < 0.5
    blob = (0.05 * rng.standard_normal((200, 2))).astype(np.float32)
    beams = Beams.with_surfaces(blob)
    assert np.median(np.hypot(beams.along_x, beams.along_y)) < 0.5


def test_a_gap_separates_two_walls():
    """A beam next to a depth jump takes its direction from its own wall only."""
    x = np.linspace(0, 1, 20)
    near = np.column_stack([x, np.full(20, 1.0)])
    far = np.column_stack([np.full(20, 3.0), np.linspace(2, 4, 20)])
    beams = Beams.with_surfaces(np.vstack([near, far]).astype(np.float32))
    np.testing.assert_allclose(np.abs(beams.along_x[:20]), 1.0, atol=1e-3)
    np.testing.assert_allclose(np.abs(beams.along_y[20:]), 1.0, atol=1e-3)


def test_plain_beams_have_none():
    """The paper's matching uses the whole gradient."""
    beams = Beams.plain(np.ones((4, 2), np.float32))
    assert not beams.along_x.any()
    assert not beams.along_y.any()


def test_any_number_of_points():
    """No points, or a few, break nothing."""
    for n in range(6):
        assert len(Beams.with_surfaces(np.zeros((n, 2), np.float32)).xs) == n
