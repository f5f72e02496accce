from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from slam_core.config import NavigationConfig
from slam_core.measurements import Float64s, Imu
from slam_core.navigation.chi_square import bound
from slam_core.navigation.corrections import Correction, HeightAid, PlanarPose
from slam_core.navigation.filter import NavigationFilter
from slam_core.results import AidingStatus
from tests.motions import GRAVITY, stamp

CONFIG = NavigationConfig()
R = np.diag([0.02, 0.02, 0.01]) ** 2


class Fix(Correction):
    """A position in space, as by satellites."""

    source, measures, usable, gate = "fix", (3, 4, 5), True, 5.0

    def __init__(self, position: Float64s) -> None:
        self.position = position

    def observe(self, x: Float64s) -> tuple[Float64s, Float64s, Float64s]:
        """Good to a decimetre."""
        return self.position - x[4:7], np.eye(3, 15, 3), 0.01 * np.eye(3)


def standing(seconds: float, begin: float = 0.0, estimator: NavigationFilter | None = None) -> NavigationFilter:
    """A filter whose base has not moved."""
    estimator = estimator or NavigationFilter(CONFIG)
    for k in range(round(100 * begin), round(100 * seconds) + 1):
        estimator.predict(Imu(stamp(k / 100), np.zeros(3), -GRAVITY))
    return estimator


def told(estimator: NavigationFilter, corrections: Iterator[tuple[float, Correction]], begin: float) -> None:
    """A base that stands still and hears corrections."""
    for t, correction in corrections:
        standing(t, begin + 0.01, estimator)
        begin = round(t, 2)
        estimator.correct(stamp(t), correction)


def status(estimator: NavigationFilter, source: str) -> AidingStatus:
    """What is known of a source."""
    return next(found for found in estimator.aiding if found.source == source)


def test_a_measurement_out_of_all_bounds_changes_nothing() -> None:
    """It is counted with its innovation, sigma, normalised square and bound; an open gate lets it in."""
    estimator = standing(1.0)
    before = estimator.state
    assert estimator.update_height(stamp(1.0), 30.0)
    found = status(estimator, "height")
    assert (found.used, found.rejected, found.streak, found.accepted) == (0, 1, 1, False)
    assert found.innovation[0] == pytest.approx(30.0, abs=0.01) and found.stamp_ns == stamp(1.0)
    assert found.nis == pytest.approx((found.innovation[0] / found.sigma[0]) ** 2) and found.nis > found.bound
    assert found.bound == bound(5.0, 1)
    assert np.array_equal(before.covariance, estimator.state.covariance)
    estimator.configure(replace(CONFIG, height_gate=0.0))
    assert estimator.update_height(stamp(1.0), 30.0)
    assert status(estimator, "height").accepted and estimator.state.T_map_base.translation[2] > 0.01


def test_what_passes_is_counted_by_its_source() -> None:
    """Used, when last, and each source for itself; what could not be used at all is named."""
    estimator = standing(1.0)
    for height in (0.0, 0.1, np.nan):
        estimator.update_height(stamp(1.0), height)
    estimator.fuse_planar(stamp(0.9), np.zeros(3), R, 0.1)
    estimator.update_velocity_body(stamp(0.95), np.zeros(2), 0.1)
    height, scan, wheels = (status(estimator, name) for name in ("height", "scan", "wheels"))
    assert (height.used, height.rejected, height.used_ns) == (2, 0, stamp(1.0))
    assert dict(height.dropped) == {"correction without a usable value": 1}
    assert (scan.used, scan.used_ns, len(scan.innovation)) == (1, stamp(0.9), 3)
    assert (wheels.used, wheels.dropped) == (1, {})


def test_a_measurement_is_counted_once_however_often_it_is_applied() -> None:
    """A late correction makes the filter apply all later ones again."""
    estimator = standing(1.0)
    for t in (0.95, 0.9, 0.8, 0.7):
        estimator.update_height(stamp(t), 0.0)
    assert status(estimator, "height").used == 4


def test_chance_is_let_in() -> None:
    """Of heights with the noise that is claimed none in a thousand is rejected at five sigmas."""
    estimator, rng = standing(1.0), np.random.default_rng(4)
    noisy = ((1.0 + k / 10, HeightAid(0.2 * rng.normal(), 0.2, 5.0)) for k in range(1, 1000))
    told(estimator, noisy, 1.0)
    assert status(estimator, "height").rejected == 0


def test_a_jump_is_kept_out_and_forgotten() -> None:
    """Satellites that are 50 m off for three seconds move nothing, and are used again once they are right."""
    estimator = standing(1.0)
    jumping = ((1.0 + k / 5, Fix(np.array([50.0 * (10 <= k < 25), 0.0, 0.0]))) for k in range(1, 40))
    told(estimator, jumping, 1.0)
    found = status(estimator, "fix")
    assert (found.rejected, found.returns, found.accepted) == (15, 0, True)
    assert np.linalg.norm(estimator.state.T_map_base.translation) < 0.2


def test_a_source_that_insists_is_believed_when_nobody_contradicts_it() -> None:
    """After the patience a filter that was wrong takes the position over, and only the position."""
    estimator = standing(1.0)
    told(estimator, ((1.0 + k / 5, Fix(np.zeros(3))) for k in range(1, 20)), 1.0)
    told(estimator, ((4.8 + k / 5, Fix(np.array([50.0, 0.0, 0.0]))) for k in range(1, 40)), 4.8)
    found, state = status(estimator, "fix"), estimator.state
    assert found.returns == 1 and found.accepted
    assert 24 <= found.rejected <= 28  # five a second for five seconds
    assert np.allclose(state.T_map_base.translation, [50.0, 0.0, 0.0], atol=0.3)
    assert np.linalg.norm(state.velocity) < 0.5 and np.isfinite(state.covariance).all()


def test_what_others_vouch_for_is_not_given_up() -> None:
    """A match says where the base is in the plane: satellites that contradict it stay out, however long."""
    estimator = standing(1.0)

    def both() -> Iterator[tuple[float, Correction]]:
        for k in range(1, 60):
            yield 1.0 + k / 5, PlanarPose(np.zeros(3), R, 0.3)
            yield 1.0 + k / 5, Fix(np.array([50.0, 0.0, 0.0]))

    told(estimator, both(), 1.0)
    found = status(estimator, "fix")
    assert (found.used, found.returns, found.streak) == (0, 0, 59) and found.streak_ns == stamp(1.2)
    assert np.linalg.norm(estimator.state.T_map_base.translation[:2]) < 0.1


def test_outliers_that_disagree_never_come_back() -> None:
    """A source that says something else every time is not a filter that was wrong."""
    estimator, rng = standing(1.0), np.random.default_rng(2)
    wild = ((1.0 + k / 5, Fix(rng.uniform(-200.0, 200.0, 3))) for k in range(1, 100))
    told(estimator, wild, 1.0)
    found = status(estimator, "fix")
    assert found.returns == 0 and found.used == 0
    assert np.linalg.norm(estimator.state.T_map_base.translation) < 5.0
