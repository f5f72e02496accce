"""The fast core under the paper's configuration agrees with the paper in plain numpy, scan by scan.

What differs by design: the core keeps probabilities in parts of 2^16 (7.6e-6 of a probability) and endpoints in
float32 (1e-6 of 10 m). Most matches agree to some micrometres. Now and then an endpoint lies so near to the edge
of a cell that the two read gradients on different sides of it; six iterations then end some tenths of a millimetre
apart, and the next match agrees again.
"""

import itertools
from collections.abc import Iterable, Iterator

import numpy as np
import pytest

from hectorscope.cli.opening import demo_bag
from hectorscope.inputs import Item, SourceOptions
from hectorscope.sources import open_source
from slam_core.config import SlamConfig
from slam_core.measurements import Imu, LaserScan
from slam_core.reference import ReferenceScan, ReferenceSlam
from slam_core.results import StepResult
from slam_core.sequencer import Sequencer
from slam_core.slam import HectorSlam

SCANS = 40
Pair = tuple[StepResult, ReferenceScan]


def both(items: Iterable[Item], config: SlamConfig) -> tuple[list[Pair], HectorSlam, ReferenceSlam]:
    """The results of the core and of the reference on the scans and inertial data among the items."""
    fast, reference, sequencer = HectorSlam(config), ReferenceSlam(config), Sequencer()
    pairs = list(itertools.islice(_pairs(items, fast, reference, sequencer), SCANS))
    return pairs, fast, reference


def _pairs(
    items: Iterable[Item], fast: HectorSlam, reference: ReferenceSlam, sequencer: Sequencer
) -> Iterator[Pair]:
    for item in items:
        if not isinstance(item, LaserScan | Imu):
            continue
        for measurement in sequencer.push(item):
            result, found = fast.step(measurement), reference.step(measurement)
            assert (result is None) == (found is None)
            if result is not None and found is not None:
                yield result, found


@pytest.fixture(scope="module")
def arena() -> tuple[list[Pair], HectorSlam, ReferenceSlam]:
    """The first scans of the arena demo, with inertial data."""
    source = open_source(str(demo_bag("arena")), SourceOptions())
    try:
        return both(source.items(), SlamConfig.paper())
    finally:
        source.close()


def check_matches(pairs: list[Pair]) -> None:
    """Poses within 1 mm and 1 mrad, nine in ten within 1 % of that; R of (15) within 2 %; the same keyframes."""
    assert len(pairs) == SCANS
    apart = np.array([np.abs(result.planar - found.pose).max() for result, found in pairs])
    assert apart.max() < 1e-3
    assert np.quantile(apart, 0.9) < 1e-5
    for result, found in pairs:
        assert result.map_updated == found.written
        if result.match is not None:
            np.testing.assert_allclose(result.match.covariance, found.R, atol=0.02 * np.abs(found.R).max())


def test_matches_agree(arena):
    """With inertial data the start of a match is the projected filter."""
    check_matches(arena[0])


def test_states_agree(arena):
    """Attitude, position, velocity and biases of the filter, and P relative to its standard deviations."""
    for result, found in arena[0]:
        state, nav = found.state, result.navigation
        assert state is not None and nav is not None
        np.testing.assert_allclose(nav.x[:4], state.q, atol=1e-4)
        np.testing.assert_allclose(nav.x[4:7], state.p, atol=1e-3)
        np.testing.assert_allclose(nav.x[7:10], state.v, atol=1e-3)
        np.testing.assert_allclose(nav.x[10:16], [*state.b_omega, *state.b_a], atol=1e-4)
        sigmas = np.sqrt(np.diag(state.P))
        scale = np.outer(sigmas, sigmas)
        np.testing.assert_allclose(nav.covariance / scale, state.P / scale, atol=0.02)


def test_maps_agree(arena):
    """At most one cell in a thousand differs, on every level: one that a beam met at its edge."""
    _, fast, reference = arena
    for level, expected in zip(fast.map.levels, reference.map.levels, strict=True):
        assert (level.corner == expected.corner).all()
        differ = np.abs(level.log_odds - expected.log_odds) > 1e-3
        assert np.count_nonzero(differ) <= 1e-3 * np.count_nonzero(expected.log_odds)


def test_every_iteration_is_there(arena):
    """Four on each coarser level, six on the finest; each begins where the one before ended, the last at xi*."""
    _, found = arena[0][-1]
    levels = [iteration.level for iteration in found.iterations]
    assert levels == [2] * 4 + [1] * 4 + [0] * 7
    for before, after in itertools.pairwise(found.iterations):
        np.testing.assert_allclose(before.pose + before.step, after.pose, atol=1e-12)
    assert not found.iterations[-1].step.any()
    assert found.iterations[-1].cost <= found.iterations[-7].cost
