"""What compiled loops without branches say of a scan's endpoints, against the same said plainly."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from slam_core.geometry import transform_points
from slam_core.kernels.bilinear import UNKNOWN
from slam_core.kernels.dynamic_objects import BIN, BINS, by_bearing
from slam_core.mapping.grid import GridLevel
from slam_core.results import Fit
from tests.worlds import fit

seeds = st.integers(0, 10_000)


def speckled(seed: int) -> tuple[GridLevel, np.ndarray, np.ndarray]:
    """A level of unknown, free and a few occupied cells, and a scan of which some ends lie off the map."""
    rng = np.random.default_rng(seed)
    level = GridLevel(0.1, (rng.integers(9, 30), rng.integers(9, 30)), -rng.integers(0, 20, 2) * 0.1)
    level.cells[:] = rng.choice([UNKNOWN, -23768, 27232], level.shape, p=[0.3, 0.67, 0.03])
    points = rng.uniform(-2.5, 2.5, (200, 2)).astype(np.float32)
    return level, points, rng.uniform(-0.5, 0.5, 3) * [1.0, 1.0, 6.0]


def cells_at(level: GridLevel, points: np.ndarray, pose: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Column and row of every end, and which of them lie on the map."""
    u, v = level.cell_of(*transform_points(pose, points).T)
    rows, columns = level.shape
    return u, v, (u >= 0) & (u < columns) & (v >= 0) & (v < rows)


@settings(max_examples=60, deadline=None)
@given(seeds)
def test_the_fit_counts_known_and_occupied_cells_under_the_ends(seed: int) -> None:
    """Ends off the map count as unknown."""
    level, points, pose = speckled(seed)
    u, v, inside = cells_at(level, points, pose)
    under = level.cells[v[inside], u[inside]]
    known, hits = int((under != UNKNOWN).sum()), int((under > UNKNOWN).sum())
    assert fit(level, points, pose) == Fit(known / len(points), hits / max(known, 1))


@settings(max_examples=60, deadline=None)
@given(seeds, st.integers(1, 3))
def test_an_end_is_unexpected_in_the_midst_of_free_cells_alone(seed: int, around: int) -> None:
    """Free under the end, nothing occupied so many cells around it, the edge of the map no nearer than that."""
    level, points, pose = speckled(seed)
    found = level.unexpected(points, pose, around * level.resolution)
    rows, columns = level.shape
    for end, u, v in zip(found, *cells_at(level, points, pose)[:2], strict=True):
        whole = around <= u < columns - around and around <= v < rows - around
        near = level.cells[v - around : v + around + 1, u - around : u + around + 1] if whole else None
        assert end == (near is not None and level.cells[v, u] < UNKNOWN and not (near > UNKNOWN).any())


@settings(max_examples=60, deadline=None)
@given(seeds, st.floats(1e-3, 30.0))
def test_beams_are_sorted_into_the_bins_of_their_bearings(seed: int, reach: float) -> None:
    """Each is in the bin that the arc tangent gives, also along the edge of two; so is the longest of each."""
    rng = np.random.default_rng(seed)
    angles = np.concatenate([rng.uniform(-np.pi, np.pi, 150), rng.integers(-BINS // 2, BINS // 2, 50) * BIN])
    ways = reach * rng.uniform(0.1, 1.0, len(angles))
    ends = np.stack([ways * np.cos(angles), ways * np.sin(angles)], axis=1)
    lengths, begin, longest, box = by_bearing(np.zeros(2), ends)
    bins = np.array([math.floor(math.atan2(y, x) / BIN) % BINS for x, y in ends.tolist()])
    assert np.diff(begin).tolist() == np.bincount(bins, minlength=BINS).tolist()
    for b in range(BINS):
        wanted = np.sort(np.hypot(*ends[bins == b].T))
        assert np.allclose(np.sort(lengths[begin[b] : begin[b + 1]]), wanted, rtol=1e-12, atol=0)
        assert longest[b] == lengths[begin[b] : begin[b + 1]].max(initial=-1.0)
    assert (box[0] <= ends.min(axis=0)).all() and (box[1] >= ends.max(axis=0)).all()
