"""Which endpoints lie on the surface around each, compared with the rule as it is said."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from slam_core.kernels.surfaces import DIRECTED, FLAT, GAP, GROWTH, NEIGHBOURS, REACH, STRAIGHT, _neighbours

Steps = list[tuple[float, float]]  # metres and radians: how far to the next endpoint, and how the way turns there
steps = st.lists(
    st.tuples(st.sampled_from([0.0, 0.01, 0.055, 0.07, 0.2, 0.29, 0.31, 0.7, 1.5, 9.0]), st.floats(-2.0, 2.0)),
    max_size=40,
)


@settings(max_examples=200, deadline=None)
@given(steps, st.floats(0.0, 0.5))
def test_neighbours_are_those_of_one_surface_within_reach(way: Steps, bends: float) -> None:
    """Joined by small steps, by one like its neighbour or a long one straight on; near by way or by order."""
    points = _points(way, bends)
    n = len(points)
    first, end = np.full(n, -1, np.int32), np.full(n, -1, np.int32)
    _neighbours(points[:, 0].copy(), points[:, 1].copy(), first, end)
    moves = np.diff(points, axis=0)  # single precision, as in the kernel
    lengths = np.sqrt(moves[:, 0] * moves[:, 0] + moves[:, 1] * moves[:, 1]).astype(np.float64)
    along = np.concatenate([[0], np.cumsum((lengths * 1e12).astype(np.int64))])  # picometres
    joined = _joined(moves, lengths)

    def together(i: int, j: int) -> bool:
        low, high = min(i, j), max(i, j)
        near = high - low <= NEIGHBOURS or along[high] - along[low] <= REACH
        return near and all(joined[low:high])

    for i in range(n):
        assert [j for j in range(n) if together(i, j)] == list(range(first[i], end[i]))


def _points(way: Steps, bends: float) -> np.ndarray:
    headings = bends * np.cumsum([turn for _, turn in way])
    ends = np.array(
        [[0.0, 0.0], *([s * np.cos(a), s * np.sin(a)] for (s, _), a in zip(way, headings, strict=True))]
    )
    return np.cumsum(ends, axis=0).astype(np.float32)


def _joined(moves: np.ndarray, lengths: np.ndarray) -> list[bool]:
    """Of every step from an endpoint to the next."""
    joined = [bool(length <= GAP) for length in lengths]
    for i in range(1, len(lengths)):
        small, large = sorted(lengths[i - 1 : i + 1])
        ahead = moves[i][0] * moves[i - 1][0] + moves[i][1] * moves[i - 1][1]
        aside = moves[i][0] * moves[i - 1][1] - moves[i][1] * moves[i - 1][0]
        across = moves[i] + moves[i - 1]
        flat = aside * aside <= FLAT * FLAT * np.float64(across[0] * across[0] + across[1] * across[1])
        alike = large <= GROWTH * small or (flat and small >= DIRECTED)
        if alike and ahead >= STRAIGHT * lengths[i] * lengths[i - 1]:
            joined[i - 1] = joined[i] = True
    return joined
