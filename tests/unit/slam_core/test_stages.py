import numpy as np
import pytest

from slam_core.config import NavigationConfig, PlatformConfig
from slam_core.kernels.navigation import ERRORS, STATES
from slam_core.samples import Samples
from slam_core.stages import FIRST_SIZE, Stages
from slam_core.strapdown import Strapdown

MODEL = Strapdown(NavigationConfig(), PlatformConfig())
STEP_NS = 10_000_000
SAMPLES = Samples()
for _k in range(5 * FIRST_SIZE):
    SAMPLES.append(_k * STEP_NS, np.array([0.1, -0.2, 0.3, 0.5, 0.1, 9.8, 0.0]))
X, P = np.eye(1, STATES)[0], 1e-4 * np.eye(ERRORS)
BEGIN_NS = STEP_NS // 2  # between two samples


def predicted(to_ns: int) -> tuple[np.ndarray, np.ndarray]:
    """From the beginning to one of the samples, a sample at a time."""
    x, spread, at_ns = X, P, BEGIN_NS
    while at_ns < to_ns:
        next_ns = (at_ns // STEP_NS + 1) * STEP_NS
        x, spread = MODEL.predict(x, spread, at_ns, next_ns, SAMPLES)
        at_ns = next_ns
    return x, spread


@pytest.mark.parametrize(
    "steps", [(3,), (1, 2, 3), (FIRST_SIZE - 1, FIRST_SIZE, FIRST_SIZE + 1), (4 * FIRST_SIZE,)]
)
def test_every_sample_on_the_way_has_its_belief(steps: tuple[int, ...]) -> None:
    """However far and in whatever pieces it goes on, the rows are the predictions from sample to sample."""
    stages = Stages(BEGIN_NS, X, P)
    for k in steps:
        stages.reach(k * STEP_NS + 1, MODEL, SAMPLES)
        stamp_ns, x, spread = stages.last(k * STEP_NS + 1)
        assert stamp_ns == k * STEP_NS
        for got, wanted in zip((x, spread), predicted(stamp_ns), strict=True):
            assert np.array_equal(got, wanted)
    assert [len(rows) for rows in stages.until(2 * STEP_NS)] == ([3, 3] if steps[-1] > 1 else [2, 2])


def test_an_instant_before_the_first_row_gets_the_first() -> None:
    """Nothing is known of what was before it begins."""
    stages = Stages(BEGIN_NS, X, P)
    stages.reach(3 * STEP_NS, MODEL, SAMPLES)
    assert stages.last(0)[0] == BEGIN_NS
    assert stages.until(0)[1].tolist() == [BEGIN_NS]


def test_what_goes_on_from_a_later_row_is_the_same() -> None:
    """After a new beginning at one of the rows the others are as before, and it goes on as it would have."""
    stages = Stages(BEGIN_NS, X, P)
    stages.reach(6 * STEP_NS, MODEL, SAMPLES)
    later = stages.since(*stages.last(3 * STEP_NS))
    for each in (stages, later):
        each.reach(20 * STEP_NS, MODEL, SAMPLES)
    assert later.last(0)[0] == 3 * STEP_NS
    for k in (4, 6, 7, 20):
        assert np.array_equal(stages.last(k * STEP_NS)[2], later.last(k * STEP_NS)[2])


def test_a_copy_goes_its_own_way() -> None:
    """Rows that are added to a copy are not seen in the original."""
    stages = Stages(BEGIN_NS, X, P)
    stages.copy().reach(5 * STEP_NS, MODEL, SAMPLES)
    assert stages.last(5 * STEP_NS)[0] == BEGIN_NS
