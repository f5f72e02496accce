import numpy as np
import pytest

from slam_core.config import NavigationConfig, PlatformConfig
from slam_core.kernels.navigation import ERRORS, STATES
from slam_core.navigation.imu_buffer import ImuBuffer
from slam_core.navigation.state_buffer import FIRST_SIZE, StateBuffer
from slam_core.navigation.strapdown import Strapdown

MODEL = Strapdown(NavigationConfig(), PlatformConfig())
STEP_NS = 10_000_000
SAMPLES = ImuBuffer()
for _k in range(5 * FIRST_SIZE):
    SAMPLES.append(_k * STEP_NS, np.array([0.1, -0.2, 0.3, 0.5, 0.1, 9.8, 0.0, 0.0]))
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


def belief(stages: StateBuffer, time_ns: int) -> tuple[np.ndarray, np.ndarray]:
    """The state and its covariance at an instant."""
    return stages.estimate(time_ns, MODEL, SAMPLES)[:2]


@pytest.mark.parametrize(
    "steps", [(3,), (1, 2, 3), (FIRST_SIZE - 1, FIRST_SIZE, FIRST_SIZE + 1), (4 * FIRST_SIZE,), (5, 2)]
)
def test_every_sample_on_the_way_has_its_belief(steps: tuple[int, ...]) -> None:
    """However far and in whatever pieces it goes on, the rows are the predictions from sample to sample."""
    stages = StateBuffer(BEGIN_NS, X, P)
    for k in steps:
        for got, wanted in zip(belief(stages, k * STEP_NS), predicted(k * STEP_NS), strict=True):
            assert np.array_equal(got, wanted)
    assert stages.stamps.tolist() == [BEGIN_NS, *[k * STEP_NS for k in range(1, max(steps) + 1)]]


def test_several_states_are_those_of_the_beliefs() -> None:
    """Whatever the order of the instants and wherever they lie, the states are as if each were asked for alone."""
    times = [12 * STEP_NS + 7, BEGIN_NS, 3 * STEP_NS, 0, 40 * STEP_NS + 1]
    states = StateBuffer(BEGIN_NS, X, P).estimate(times[0], MODEL, SAMPLES, 0, np.array(times))[2]
    for state, time_ns in zip(states, times, strict=True):
        assert np.allclose(state, belief(StateBuffer(BEGIN_NS, X, P), time_ns)[0], rtol=0, atol=1e-12)


def test_an_instant_before_the_first_row_gets_the_first() -> None:
    """Nothing is known of what was before it begins."""
    stages = StateBuffer(BEGIN_NS, X, P)
    belief(stages, 3 * STEP_NS)
    assert np.array_equal(belief(stages, 0)[0], X) and np.array_equal(belief(stages, 0)[1], P)


def test_what_goes_on_from_a_later_row_is_the_same() -> None:
    """After a new beginning at one of the rows the others are as before, and it goes on as it would have."""
    stages = StateBuffer(BEGIN_NS, X, P)
    belief(stages, 6 * STEP_NS)
    later = stages.since(3 * STEP_NS, *belief(stages, 3 * STEP_NS))
    assert later.stamps.tolist() == [k * STEP_NS for k in (3, 4, 5, 6)]
    for k in (4, 6, 7, 20):
        assert np.array_equal(belief(stages, k * STEP_NS)[1], belief(later, k * STEP_NS)[1])


def test_a_copy_goes_its_own_way() -> None:
    """Rows that are added to a copy are not seen in the original."""
    stages = StateBuffer(BEGIN_NS, X, P)
    belief(stages.copy(), 5 * STEP_NS)
    assert stages.stamps.tolist() == [BEGIN_NS]
