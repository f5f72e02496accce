"""Acceptance of a match: it must put the scan on occupied cells about as well as the matches before it did."""

import math

import numpy as np

from slam_core import geometry
from slam_core.config import TrackingConfig
from slam_core.kernels.planar import sigmas_apart
from slam_core.measurements import Float32s
from slam_core.results import ACCEPTED, Fit, MatchResult, PlanarGaussian, Rejection, Verdict

USUAL_INLIER_RATIO = 0.9  # before any match was accepted
MEMORY = 0.05  # weight of the newest match in the running mean
MOSTLY = 0.6  # of the endpoints of a scan: so many on known cells show where it was taken
NEAR = 5.0  # sigmas from the prediction: a scan with fewer known ones is rejected beyond
TIMES = 5.0  # the usual distance between match and prediction: further off is unusual
# Metres from the prediction, or what a change of speed (m/s) makes of the time between two scans; nearer is usual.
UNUSUAL, UNUSUAL_CHANGE = 0.08, 0.4
LEAP, LEAP_SIGMAS = 0.4, 4.0  # metres, standard deviations: an unusual distance beyond both is no motion
SHARP = 0.02  # radians, one sigma of a heading; inertial data predict it to some milliradians
BASIN = 0.3  # radians of heading error from which Gauss-Newton converges in most scans
POOR, GOOD = 0.95, 0.9  # of the usual inlier ratio: less is worse than most; so much is enough to be trusted
CLEARLY = 0.1  # more endpoints on walls, as a share of all: so many show that another match is the better one
FEWEST = 20  # endpoints: fewer fit a map at many places
UNCERTAIN = 1.0  # metres, one sigma: a position that is known worse is not called tracked
BEYOND = 0.5  # metres, radians that a match may end outside of a window
LEAST_WINDOW = (0.5, 0.3)  # metres, radians: the covariance of a prediction that failed may be too small


def mahalanobis_distance(match: MatchResult, prior: PlanarGaussian) -> float:
    """Distance of match and prediction in sigmas of both together."""
    return float(sigmas_apart(match.pose, match.covariance, prior.mean, prior.covariance))


def sigmas_off(match: MatchResult, prior: PlanarGaussian) -> float:
    """Distance of the positions of match and prediction in sigmas of both together."""
    off = match.pose[:2] - prior.mean[:2]
    P = prior.covariance[:2, :2] + match.covariance[:2, :2]
    return math.sqrt(float(off @ np.linalg.solve(P, off)))


def exceeds_basin(prior: PlanarGaussian) -> bool:
    """Whether three sigmas of the predicted heading leave the basin of convergence of the matcher."""
    return 9.0 * prior.covariance.item(2, 2) > BASIN**2


def is_sharp(prior: PlanarGaussian) -> bool:
    """Whether the heading is predicted as well as inertial data of a base that is not shaken do."""
    return prior.covariance.item(2, 2) < SHARP**2


def least_unusual(lapse_ns: int) -> float:
    """Metres from the prediction from which a match is unusual so long after the one before."""
    return min(UNUSUAL, UNUSUAL_CHANGE * max(lapse_ns, 0) * 1e-9)


def search_window(prior: PlanarGaussian, config: TrackingConfig) -> tuple[float, float]:
    """Metres and radians around a prediction in which the pose is searched: three sigmas, within limits."""
    x, y, psi = (3.0 * math.sqrt(variance) for variance in prior.covariance.diagonal().tolist())
    distance = min(max(x, y, LEAST_WINDOW[0]), config.search_distance)
    return distance, min(max(psi, LEAST_WINDOW[1]), config.search_angle)


def is_beyond(match: MatchResult, prior: PlanarGaussian, config: TrackingConfig) -> bool:
    """Whether a match has left the window of a search: in a scan with few known cells it runs off for metres."""
    distance, angle = search_window(prior, config)
    turned = abs(geometry.wrap(match.pose[2] - prior.mean[2]))
    return prior.distance_to(match.pose) > distance + BEYOND or turned > angle + BEYOND


def observed(verdict: Verdict, match: MatchResult | None, fused: PlanarGaussian) -> Verdict:
    """The verdict; *degraded* where a scan leaves one direction to the prediction, which has become uncertain."""
    if match is None or not match.leaves_direction or verdict.state not in ("tracking", "recovered"):
        return verdict
    sigma = math.sqrt(float(match.unobservable @ fused.covariance[:2, :2] @ match.unobservable))
    if sigma <= UNCERTAIN:
        return verdict
    return verdict._replace(state="degraded", rejection=Rejection("unobservable", sigma, UNCERTAIN))


def too_few(points: Float32s) -> Rejection | None:
    """Why a scan with these endpoints (n, 2) tells no place; None if it may."""
    return Rejection("endpoints", len(points), FEWEST) if len(points) < FEWEST else None


def is_good(fit: Fit, usual: float) -> bool:
    """Whether a match lies on mostly known cells and fits nearly as well as usual (mean inlier ratio)."""
    return fit.known >= MOSTLY and fit.hit >= GOOD * usual


class Tracker:
    """The running mean of the inlier ratio, and the number of rejected matches since the last accepted one.

    is_missing: a scan since then told nothing.
    """

    def __init__(self) -> None:
        self._usual = USUAL_INLIER_RATIO
        self._usual_distance = 0.0
        self.reset()

    @property
    def usual(self) -> float:
        """The running mean of the inlier ratio."""
        return self._usual

    def is_poor(self, fit: Fit) -> bool:
        """Whether a match fits worse than most did, or puts a good part of the scan where nothing is known."""
        return fit.known < MOSTLY or fit.hit < POOR * self._usual

    def is_bad(self, fit: Fit) -> bool:
        """Whether a match on mostly known cells fits much worse than most did."""
        return fit.known >= MOSTLY and not is_good(fit, self._usual)

    def is_better(self, found: Fit, fit: Fit) -> bool:
        """Whether a match that a search found fits clearly better than another, and not badly."""
        return is_good(found, self._usual) and found.hit >= fit.hit + CLEARLY

    def check(self, fit: Fit, distance: float, config: TrackingConfig) -> Rejection | None:
        """The reason to reject a match; None if there is none. distance: to the prediction, sigmas."""
        if fit.known < config.min_overlap:
            return Rejection("overlap", fit.known, config.min_overlap)
        if fit.hit < config.min_inlier_ratio * self._usual:
            return Rejection("inlier_ratio", fit.hit, self._usual)
        if _astray(fit, distance):
            return Rejection("mahalanobis_distance", distance, NEAR)
        return None

    def confirms(self, fit: Fit, distance: float, config: TrackingConfig) -> bool:
        """Whether a pose that a search found is accepted: it must fit clearly better than a suspect match."""
        if fit.known < config.min_overlap or _astray(fit, distance):
            return False
        return fit.hit >= 0.5 * (1.0 + config.min_inlier_ratio) * self._usual

    def leaps(self, match: MatchResult, prior: PlanarGaussian) -> bool:
        """Whether the position is so far from the prediction that the match is more likely wrong than a motion.

        Where a laser that sways makes all predictions bad, a large distance tells nothing.
        """
        if not self.is_unusual(match, prior, LEAP):
            return False
        return sigmas_off(match, prior) > LEAP_SIGMAS

    def is_unusual(self, match: MatchResult, prior: PlanarGaussian, least: float) -> bool:
        """Whether the position is much further from the prediction than those before, and than `least` metres."""
        return prior.distance_to(match.pose) > max(least, TIMES * self._usual_distance)

    def learn(self, match: MatchResult, prior: PlanarGaussian) -> None:
        """Take a match whose pose is sure into the running means."""
        self._usual += MEMORY * (match.fit.hit - self._usual)
        self._usual_distance += MEMORY * (prior.distance_to(match.pose) - self._usual_distance)

    def accept(self, rejection: Rejection | None) -> Verdict:
        """Continue from a match. rejection: why it had to be searched for, if it had."""
        recovered = rejection is not None or self._rejected > 0 or self.is_missing
        self.reset()
        return Verdict("recovered", rejection) if recovered else ACCEPTED

    def miss(self) -> None:
        """A scan tells nothing: the next match that is accepted follows no other."""
        self.is_missing = True

    def reset(self) -> None:
        """The pose in the map is known, whatever was rejected before."""
        self._rejected, self.is_missing = 0, False

    def reject(self, rejection: Rejection, config: TrackingConfig) -> Verdict:
        """Continue from the prediction."""
        self._rejected += 1
        return Verdict("degraded" if self._rejected < config.lost_after else "lost", rejection, accepted=False)


def _astray(fit: Fit, distance: float) -> bool:
    """Whether a scan that mostly lies on unknown cells was matched far from the prediction."""
    return fit.known < MOSTLY and distance > NEAR
