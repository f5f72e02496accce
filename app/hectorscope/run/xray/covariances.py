"""Prior, scan and their fusion by eqs. (18)-(20), beside the Kalman update; and a cloud that shows the truth."""

from dataclasses import dataclass, replace

import numpy as np

from hectorscope.run.xray.match_problem import MatchProblem
from slam_core.measurements import Float32s, Float64s
from slam_core.reference.covariance_intersection import intersect, kalman_update
from slam_core.reference.scan_matching import evaluate, hessian_covariance, sampled_covariance

OMEGAS = np.linspace(0.001, 0.999, 999)
MATCHES = 400  # of a whole cloud
SEED = 25


@dataclass(frozen=True, eq=False)
class Fusion:
    """Covariances (3, 3), metres and radians. omega: of `fused`. best: the omega with the least determinant.

    P: prior. R: of (15) by the reference. sampled: the alternative of section IV-B. fused: by (18). kalman: as if
    both were independent. optimal: by (18) with the best omega.
    """

    omega: float
    best: float
    P: Float64s
    R: Float64s
    sampled: Float64s
    fused: Float64s
    kalman: Float64s
    optimal: Float64s

    def at(self, omega: float) -> "Fusion":
        """The same with another omega: nothing else depends on it."""
        return replace(self, omega=omega, fused=fused(self.P, self.R, omega))


def fusion(problem: MatchProblem, omega: float) -> Fusion:
    """Of the prediction and the match of the shown scan."""
    points, sigma = problem.points.astype(np.float64), problem.config.matcher.sigma
    H = evaluate(problem.grids[0], points, problem.matched).H
    R = hessian_covariance(H, sigma)
    sampled = sampled_covariance(problem.grids[0], points, problem.matched, sigma)
    P = problem.prior.covariance
    best = best_omega(P, R)
    kalman = kalman_update(P, np.eye(3), R, np.zeros(3))[1]
    return Fusion(omega, best, P, R, sampled, fused(P, R, omega), kalman, fused(P, R, best))


def fused(P: Float64s, R: Float64s, omega: float) -> Float64s:
    """P+ of eq. (18)."""
    zero = np.zeros(3)
    return intersect(zero, P, np.eye(3), zero, R, omega)[1]


def best_omega(P: Float64s, R: Float64s) -> float:
    """The omega of OMEGAS with the least determinant of P+."""
    information = (1.0 - OMEGAS)[:, None, None] * np.linalg.inv(P) + OMEGAS[:, None, None] * np.linalg.inv(R)
    return float(OMEGAS[np.argmax(np.linalg.slogdet(information)[1])])


class Cloud:
    """Ends of matches of the same scan with noisy ranges. The same seed and number give the same cloud.

    noise: standard deviation of a range, metres. offsets: of each match from the mean of all, in `covariance`.
    """

    def __init__(self, problem: MatchProblem, noise: float) -> None:
        self._problem, self.noise = problem, noise
        self._random = np.random.default_rng(SEED)
        self._ends: list[Float64s] = []

    def __len__(self) -> int:
        return len(self._ends)

    @property
    def whole(self) -> bool:
        """Whether there are as many as there will be."""
        return len(self._ends) >= MATCHES

    def try_next(self) -> None:
        """One more match."""
        self._ends.append(self._problem.end(self._problem.matched, self._noisy()).pose)

    @property
    def ends(self) -> Float64s:
        """(k, 3) the poses so far."""
        return np.array(self._ends).reshape(-1, 3)

    @property
    def covariance(self) -> Float64s:
        """(3, 3) of the ends; zeros for fewer than two."""
        ends = self.ends
        if len(ends) < 2:
            return np.zeros((3, 3))
        ends[:, 2] = np.remainder(ends[:, 2] - self._problem.matched[2] + np.pi, 2.0 * np.pi)
        return np.asarray(np.cov(ends.T), np.float64)

    def _noisy(self) -> Float32s:
        beams = self._problem.points - self._problem.laser
        ranges = np.linalg.norm(beams, axis=1, keepdims=True)
        noise = self._random.normal(0.0, self.noise, (len(beams), 1))
        moved: Float32s = (self._problem.points + noise * beams / np.maximum(ranges, 1e-6)).astype(np.float32)
        return moved
