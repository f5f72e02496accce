"""Rest, told from inertial data alone."""

import numpy as np

from slam_core.measurements import Imu
from slam_core.navigation.aiding.standstill import WINDOW_NS, Rest, StandstillDetector, at_rest


def samples(rate: np.ndarray, seed: int = 0, n: int = 200) -> np.ndarray:
    """White noise of a consumer device at 100 Hz around a rate (n, 3), and gravity."""
    rng = np.random.default_rng(seed)
    forces = np.array([0.0, 0.0, 9.81]) + 0.03 * rng.normal(size=(n, 3))
    return np.hstack([rate + 0.005 * rng.normal(size=(n, 3)), forces])


def test_noise_alone_is_rest_and_shows_the_bias() -> None:
    """Of 200 windows at least 195 are rest, and their mean rates lie where their variance says."""
    bias = np.array([0.004, -0.002, 0.001])
    found = [at_rest(samples(bias, seed)) for seed in range(200)]
    rests = [rest for rest in found if rest is not None]
    assert len(rests) >= 195
    ratios = [((rest.rate - bias) ** 2 / rest.rate_variance).mean() for rest in rests]
    assert 0.5 < np.mean(ratios) < 1.1


def test_a_boat_on_calm_water_does_not_rest() -> None:
    """A sway of a third of a degree at 0.45 Hz, hardly more than the noise, is told from rest every time."""
    t = np.arange(200) / 100
    for phase in np.linspace(0.0, 6.0, 20):
        sway = 0.016 * np.sin(2 * np.pi * 0.45 * t + phase)[:, None] * np.array([1.0, 0.7, 0.0])
        assert at_rest(samples(sway, int(10 * phase))) is None


def test_broken_or_few_samples_are_no_rest() -> None:
    """NaN and a slow device say nothing."""
    broken = samples(np.zeros(3))
    broken[50, 2] = np.nan
    assert at_rest(broken) is None
    assert at_rest(samples(np.zeros(3), n=10)) is None


def test_windows_follow_each_other_and_gaps_begin_a_new_one() -> None:
    """Three quiet windows give three answers; after a pause the old samples are forgotten."""
    stillness, answers = StandstillDetector(), []
    for k, row in enumerate(samples(np.zeros(3), n=601)):
        answers.append(stillness.add(Imu(k * 10_000_000, row[:3], row[3:])))
    assert sum(isinstance(answer, Rest) for answer in answers) == 3
    late = 10 * WINDOW_NS
    answers = [stillness.add(Imu(late + k * 10_000_000, np.zeros(3), np.zeros(3))) for k in range(200)]
    assert not any(answers)
