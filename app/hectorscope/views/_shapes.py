"""Shapes of unit size, and how a covariance scales and turns them."""

import math

import numpy as np

from slam_core.geometry import from_rotation_matrix, yaw_quaternion
from slam_core.measurements import Float32s, Float64s

SMALLEST = 1e-4  # metres: a scale of zero cannot be drawn

Scale = tuple[float, float, float]


def ring(segments: int = 64) -> Float32s:
    """The unit circle in x, y as line segments (segments, 2, 3)."""
    angles = np.linspace(0.0, 2.0 * np.pi, segments + 1)
    points = np.stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)], axis=1).astype(np.float32)
    return np.stack([points[:-1], points[1:]], axis=1)


def disc(segments: int = 64) -> tuple[Float32s, np.ndarray]:
    """The unit disc in x, y: vertices (segments + 1, 3) and faces (segments, 3)."""
    rim = ring(segments)[:, 0]
    around = np.arange(1, segments + 1, dtype=np.uint32)
    faces = np.stack([np.zeros_like(around), around, np.roll(around, -1)], axis=1)
    return np.concatenate([np.zeros((1, 3), np.float32), rim]), faces


def ellipse(covariance: Float64s, sigmas: float) -> tuple[Scale, Float64s]:
    """Scale and quaternion that make the unit circle the ellipse of `sigmas` of a covariance (2, 2)."""
    (xx, xy), (_, yy) = covariance.tolist()
    middle, half, lean = (xx + yy) / 2, math.hypot((xx - yy) / 2, xy), math.atan2(2 * xy, xx - yy)
    along = [max(math.sqrt(max(variance, 0.0)) * sigmas, SMALLEST) for variance in (middle + half, middle - half)]
    return (along[0], along[1], 1.0), yaw_quaternion(lean / 2)


def ellipsoid(covariance: Float64s, sigmas: float) -> tuple[Scale, Float64s]:
    """Scale and quaternion that make the unit sphere the ellipsoid of `sigmas` of a covariance (3, 3)."""
    variances, axes = np.linalg.eigh(covariance)
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] = -axes[:, 0]
    along = np.maximum(np.sqrt(np.maximum(variances, 0.0)) * sigmas, SMALLEST)
    return (float(along[0]), float(along[1]), float(along[2])), from_rotation_matrix(axes)


def prism(outline: Float64s, low: float, high: float) -> tuple[Float32s, np.ndarray]:
    """A body between two heights over a convex outline (n, 2), counter-clockwise: vertices and faces."""
    n = len(outline)
    bottom = np.column_stack([outline, np.full(n, low)])
    top = np.column_stack([outline, np.full(n, high)])
    i = np.arange(n)
    j = np.roll(i, -1)
    fan = np.column_stack([np.zeros(n - 2, int), i[1:-1], i[2:]])
    walls = [np.column_stack([i, j, n + j]), np.column_stack([i, n + j, n + i])]
    faces = np.concatenate([*walls, fan[:, ::-1], n + fan]).astype(np.uint32)
    return np.concatenate([bottom, top]).astype(np.float32), faces
