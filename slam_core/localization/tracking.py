"""Whether a match can be believed: it must put the scan on walls about as well as the matches before it did."""

import math
from typing import NamedTuple

from slam_core.config import TrackingConfig
from slam_core.kernels.planar import sigmas_apart
from slam_core.results import Fit, MatchResult, PlanarGaussian, Tracking

USUAL_FIT = 0.9  # before any match was believed
MEMORY = 0.05  # weight of the newest match in the running level
# A scan of which less than this lies on known map proves little: it is not believed this far from the prediction.
MOSTLY, NEAR = 0.6, 5.0
BASIN = 0.3  # radians off within which a match from there arrives, mostly
LEAST_WINDOW = (0.5, 0.3)  # metres, radians: a prediction that failed may be too sure of itself


class Verdict(NamedTuple):
    """What became of a scan's match: if it is not believed, the pose is the prediction; reason: what is wrong.

    beyond: whether the robot got lost where there is no map yet, and has seen next to none of it since.
    """

    state: Tracking = "tracking"
    reason: str = ""
    believed: bool = True
    beyond: bool = False


WELL = Verdict()


def disagreement(match: MatchResult, prior: PlanarGaussian) -> float:
    """How many sigmas of prediction and match together lie between the two (Mahalanobis)."""
    return float(sigmas_apart(match.pose, match.covariance, prior.mean, prior.covariance))


def is_vague(prior: PlanarGaussian) -> bool:
    """Whether the heading may be so far from a prediction that a match that starts there ends elsewhere."""
    return 3.0 * math.sqrt(float(prior.covariance[2, 2])) > BASIN


def search_window(prior: PlanarGaussian, config: TrackingConfig) -> tuple[float, float]:
    """Metres and radians around a prediction in which the pose must be sought: 3 sigmas within limits."""
    x, y, psi = (3.0 * math.sqrt(variance) for variance in prior.covariance.diagonal().tolist())
    distance = min(max(x, y, LEAST_WINDOW[0]), config.search_distance)
    return distance, min(max(psi, LEAST_WINDOW[1]), config.search_angle)


class Tracker:
    """The running level of the fit, and for how many scans none was good enough, all beyond the map or not."""

    def __init__(self) -> None:
        self._usual = USUAL_FIT
        self._missed = 0
        self._beyond = True

    def doubt(self, seen: Fit, sigmas: float, config: TrackingConfig) -> str:
        """Why a match cannot be believed as it is; empty if it can."""
        if seen.known < config.min_overlap:
            return f"{seen.known:.0%} of the scan on known map, less than {config.min_overlap:.0%}"
        if seen.hit < config.min_inlier_ratio * self._usual:
            return f"{seen.hit:.0%} of the known endpoints on walls, usually {self._usual:.0%}"
        if sigmas > config.mahalanobis_limit or _astray(seen, sigmas):
            return far_off(sigmas)
        return ""

    def convinces(self, seen: Fit, sigmas: float, config: TrackingConfig) -> bool:
        """Whether a pose that was searched for is right: it must fit clearly better than one in doubt."""
        if seen.known < config.min_overlap or _astray(seen, sigmas):
            return False
        return seen.hit >= 0.5 * (1.0 + config.min_inlier_ratio) * self._usual

    def believe(self, seen: Fit, reason: str) -> Verdict:
        """Go on with a match; `reason` is why it had to be searched for, if it had."""
        self._usual += MEMORY * (seen.hit - self._usual)
        recovered = bool(reason) or self._missed > 0
        self.rest()
        return Verdict("recovered", reason) if recovered else WELL

    def rest(self) -> None:
        """The robot has its place, whatever was missed."""
        self._missed, self._beyond = 0, True

    def miss(self, seen: Fit, reason: str, config: TrackingConfig) -> Verdict:
        """Go on with the prediction."""
        self._missed += 1
        self._beyond &= seen.known < config.min_overlap
        if self._missed < config.lost_after:
            return Verdict("degraded", reason, believed=False)
        return Verdict("lost", reason, believed=False, beyond=self._beyond)


def far_off(sigmas: float) -> str:
    """The reason to doubt a match so far from the prediction."""
    return f"{sigmas:.0f} sigmas from the prediction"


def _astray(seen: Fit, sigmas: float) -> bool:
    """Whether the little that is known has drawn a match away from the prediction."""
    return seen.known < MOSTLY and sigmas > NEAR
