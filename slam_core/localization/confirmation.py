"""A pose that was found after bad matches counts once it explains several scans; before, no scan is written."""

import math

import numpy as np

from slam_core import geometry
from slam_core.config import TrackingConfig
from slam_core.localization.rejected_matches import RejectedMatches
from slam_core.localization.search_parts import AT_REST, Region
from slam_core.localization.tracking import GOOD, is_good
from slam_core.measurements import Float64s
from slam_core.results import Fit, PlanarGaussian, Verdict

NEAR = 0.6  # metres, radians from the prediction: a match further off was found, not tracked
REACH = 2.0  # metres that a lost robot can be off where it was sure last, beside its motion since
FASTER, WALK = 1.5, 1.0  # times as fast as it was seen to drive, and m/s, if that is more, it can have moved since
DRIFT = 0.1  # metres a metre: of a motion that matches at a wrong place have shown
TURNED = 1.0  # radians from the prediction: no robot turns so far between a few scans
FEW, SEVERAL = 2, 5  # scans that a pose near the prediction has to explain, and one anywhere
MOVED = 0.4  # metres, radians between them: a pose far from the prediction has to hold elsewhere, too
SIGMAS, TURN = 5.0, 0.5  # of a prediction by other sensors, and radians besides: such a heading a robot can have
# Metres, metres, radians a second: how a prediction strays while matches at a wrong place correct the filter.
STRAYS = np.array([0.5, 0.5, 0.02])
WHILE_NS = 1_000_000_000  # over which a speed is measured
RESTED = 0.05  # m/s: slower, the robot stands
STEADY = 0.15  # metres, radians: where several predictions in a row were so near, the fit may be worse than usual


class Confirmation:
    """What was sure last, and the pose that waits to be confirmed.

    pose: (3,) the last confirmed one, at first the given one. missed: scans since then. is_lost: whether a pose
    since then was found too far from the prediction to be tracked. rejected_matches: those since then.
    """

    def __init__(self, pose: Float64s) -> None:
        self.pose = pose.copy()
        self.missed = 0
        self.rejected_matches = RejectedMatches()
        self._sure_ns: int | None = None
        self._speed = Speed()
        self._found_ns, self._is_followed = 0, False
        self._found: Float64s | None = None  # where the waiting pose was found
        self._instead_of: PlanarGaussian | None = None  # the prediction there
        self._good = self._steady = 0
        self.is_lost = self._is_best = False

    @property
    def pending(self) -> bool:
        """Whether a pose waits."""
        return self._found is not None

    @property
    def is_sure(self) -> bool:
        """Whether the robot is where it was tracked to."""
        return not (self.is_lost or self.pending)

    @property
    def awaits_search(self) -> bool:
        """Whether a pose waits for a search of the map, which shows whether another place explains the scans."""
        return self.pending and self.is_lost and not self._is_best

    def agrees(self) -> None:
        """A search of the map found the pose that waits."""
        self._is_best = True

    def region(
        self, time_ns: int, pose: Float64s | None = None, predicted: PlanarGaussian | None = None
    ) -> Region | None:
        """Where the robot can have come since it was sure of its pose; None if nothing is known of that.

        pose: (3,) the one that waits, at this time. It may be wrong, but matches followed the robot since it was
        found: the robot was within reach then, and its motion since is known, but for DRIFT. predicted: where
        other sensors have it, which limits its heading, too; None without them.
        """
        motion = AT_REST
        if pose is not None and self._found is not None:
            predicted = self._instead_of if predicted is not None and self._is_followed else None
            if self._is_followed:
                time_ns, motion = self._found_ns, geometry.compose(geometry.inverse(self._found), pose)
        return self.limited(time_ns, motion, predicted)

    def limited(self, time_ns: int, motion: Float64s, predicted: PlanarGaussian | None) -> Region | None:
        """Where the robot can have been at a time, with its motion (3,) from then on.

        predicted: where other sensors had it at that time; None without them.
        """
        reached = self._reached(time_ns, motion)
        if predicted is None or self.rejected_matches.contradict:
            return reached
        x, y, psi = (SIGMAS * math.sqrt(variance) for variance in predicted.covariance.diagonal().tolist())
        heading, turn = float(predicted.mean[2]), min(math.pi, TURN + psi)
        if reached is not None and reached.radius <= REACH + max(x, y):
            return reached._replace(heading=heading, turn=turn)
        return Region(predicted.mean, REACH + max(x, y), motion, heading, turn)

    def _reached(self, time_ns: int, motion: Float64s) -> Region | None:
        if self._sure_ns is None:
            return None
        speed = max(WALK, FASTER * self._speed.fastest)
        since_s = max(0.0, (time_ns - self._sure_ns) * 1e-9)
        return Region(self.pose, REACH + speed * since_s + DRIFT * math.hypot(*motion[:2]), motion)

    @property
    def rested(self) -> bool:
        """Whether the robot stood still when it was sure last."""
        return self._speed.last < RESTED

    def accepted(
        self, pose: Float64s, fit: Fit, verdict: Verdict, prior: PlanarGaussian, usual: float, time_ns: int,
        config: TrackingConfig, *, is_unusual: bool, measured: bool,
    ) -> Verdict:  # fmt: skip
        """The verdict on an accepted match at `pose` (3,). usual: the mean inlier ratio before it.

        is_unusual: the match is so far from the prediction that it has to fit well. measured: other sensors make
        the prediction, so that a vague one follows a long time without matches.
        """
        x, y, psi = (pose - prior.mean).tolist()
        off, turned = math.hypot(x, y), abs(geometry.wrap(psi))
        is_doubtful = max(off, turned) > NEAR or (is_unusual and fit.hit < GOOD * usual)
        if self._found is None and (self.missed or is_doubtful):
            relocalised = verdict.recovery == "relocalised"
            self._found, self._good, self._steady = pose.copy(), 0, 0
            self._instead_of = prior
            self._found_ns, self._is_followed = time_ns, True
            self._is_best = relocalised
            missed_long = (measured or self.missed >= config.lost_after) and is_vague(prior)
            self.is_lost |= relocalised or missed_long or off > REACH or turned > TURNED
        elif max(off, turned) > NEAR:
            self._is_followed = False
        if self._found is None:
            self.pose, self._sure_ns = pose.copy(), time_ns
            self._speed.see(pose, time_ns)
            return verdict
        self._steady = self._steady + 1 if max(off, turned) < STEADY else 0
        self._good += is_good(fit, usual)
        if not self._is_confirmed(pose, searches=config.relocalise):
            self.missed += 1
            return verdict._replace(state="lost" if self.is_lost else "degraded", confirmed=False)
        self._speed.forget()
        self._found, self.is_lost, self.missed = None, False, 0
        self.rejected_matches = RejectedMatches()
        self.pose, self._sure_ns = pose.copy(), time_ns
        return verdict._replace(state="recovered")

    def rejected(self) -> bool:
        """Count a scan with a bad match. Whether it ends a pose that waited."""
        self.missed += 1
        failed, self._found = self.pending, None
        return failed

    def as_predicted(self, pose: Float64s, time_ns: int) -> PlanarGaussian | None:
        """Where other sensors have a robot that was found at a wrong place; None if this is not known to be wrong.

        pose: (3,) where it is by the filter, which followed the motion from the wrong place.
        """
        if self._found is None or self._instead_of is None or self.rejected_matches.contradict or not self.is_lost:
            return None
        motion = geometry.compose(geometry.inverse(self._found), pose)
        strayed = STRAYS * (time_ns - self._found_ns) * 1e-9
        before = self._instead_of
        return PlanarGaussian(geometry.compose(before.mean, motion), before.covariance + np.diag(strayed**2))

    def _is_confirmed(self, pose: Float64s, *, searches: bool) -> bool:
        """Far from the prediction several scans, from different places, must fit better there than elsewhere.

        searches: whether the map is searched for other places.
        """
        if self.is_lost:
            return self._good >= SEVERAL and (self._is_best or not searches) and self._has_moved(pose)
        return self._good >= FEW or self._steady >= SEVERAL

    def _has_moved(self, pose: Float64s) -> bool:
        assert self._found is not None
        moved = pose - self._found
        return math.hypot(*moved[:2]) >= MOVED or abs(geometry.wrap(moved[2])) >= MOVED


class Speed:
    """How fast a robot was seen to move, over at least a second. fastest, last: m/s."""

    def __init__(self) -> None:
        self.fastest = self.last = 0.0
        self._from: tuple[Float64s, int] | None = None

    def see(self, pose: Float64s, time_ns: int) -> None:
        """The next pose (3,) that is sure."""
        was, was_ns = self._from or (pose, time_ns)
        passed_ns = time_ns - was_ns
        if 0 < passed_ns < WHILE_NS:
            return
        if passed_ns > 0:  # else the first one, or the clock was set back
            self.last = math.hypot(*(pose - was)[:2]) / (passed_ns * 1e-9)
            self.fastest = max(self.fastest, self.last)
        self._from = pose.copy(), time_ns

    def forget(self) -> None:
        """Where it was: the next pose is not the next of the same motion."""
        self._from = None


def is_vague(prior: PlanarGaussian) -> bool:
    """Whether three sigmas of a prediction are more than NEAR."""
    P = prior.covariance
    return 9.0 * max(P.item(0, 0), P.item(1, 1), P.item(2, 2)) > NEAR**2
