"""Which additions are measured, and where each can act."""

from collections.abc import Mapping
from dataclasses import dataclass

from slam_core.config import ADDITIONS, Addition, SlamConfig, with_values

FULL, PAPER, LAST_POSE = "defaults", "paper", "paper, last pose"
"""Configurations that are measured besides the defaults without one addition each."""

PARTS = (
    Addition(
        "Part of `tracking.check`: rejects a match with fewer endpoints on walls than usual.",
        {"tracking.min_inlier_ratio": 0.0},
    ),
    Addition(
        "Part of `tracking.check`: rejects a match that lies mostly outside the known map.",
        {"tracking.min_overlap": 0.0},
    ),
    Addition(
        "Part of `tracking.check`: with slow scans alone, searches at a smaller distance to the prediction.",
        {"tracking.unaided_mahalanobis_limit": 1000.0},
    ),
    Addition(
        "Part of `tracking.check`: matches a scan without what may move.",
        {"tracking.ignore_dynamic": False},
    ),
    Addition(
        "Part of `tracking.check`: a laser alone counts beams where few fix a direction, or keeps the speed.",
        {"tracking.keep_speed": False},
    ),
    Addition("Uses a rejected source again when its measurements agree.", {"navigation.gate_reset_time": 60.0}),
    Addition(
        "Without an IMU, starts the match at the pose that a constant-velocity model predicts.",
        {"matcher.start_estimate": "last_pose"},
    ),
    Addition("Enlarges the map when a beam reaches its edge.", {"map.grow": False}),
)
"""What is switched off alone besides, but belongs to another addition or to what the paper leaves open."""

MEASURED = (*ADDITIONS, *PARTS)


@dataclass(frozen=True, slots=True)
class Scope:
    """Where an addition can act.

    needs: tags that a case must all have (see `benchmarks.additions.cases`). after: tracking states of which one
    must occur in the run with the defaults; `unaided` runs excepted where `surprised`. accuracy: it decides how
    exactly a map is made, which no fault shows. figure: what it changes besides the planar error.
    """

    needs: frozenset[str] = frozenset()
    after: frozenset[str] = frozenset()
    surprised: bool = False
    accuracy: bool = False
    figure: str = ""


def _needs(*tags: str, accuracy: bool = False, figure: str = "") -> Scope:
    return Scope(frozenset(tags), accuracy=accuracy, figure=figure)


_REJECTING = Scope(after=frozenset({"recovered", "degraded", "lost"}), surprised=True)
_LOST = Scope(after=frozenset({"degraded", "lost"}))
_ACCURACY = Scope(accuracy=True)
SCOPES: Mapping[str, Scope] = {
    "scan.deskew": _needs("sweep", accuracy=True),
    "scan.smooth_noise": _needs("noisy"),
    "motion.deskew_refinements": _needs("no imu", "sweep"),
    "map.factor_behind": _ACCURACY,
    "map.keyframe_max_delay": _needs("unaided"),
    "map.grow": _needs("large"),
    "matcher.surfel_weight": _ACCURACY,
    "matcher.converged_step": _ACCURACY,
    "matcher.wheels_weight": _needs("wheels", "no imu"),
    "matcher.start_estimate": _needs("no imu"),
    "tracking.check": _REJECTING,
    "tracking.min_inlier_ratio": _REJECTING,
    "tracking.min_overlap": _REJECTING,
    "tracking.unaided_mahalanobis_limit": _needs("unaided"),
    "tracking.ignore_dynamic": _needs("unaided"),
    "tracking.keep_speed": _needs("unaided"),
    "tracking.relocalise": _LOST,
    "tracking.continue_from_prediction": _LOST,
    "aiding.standstill": _needs("imu"),
    "aiding.gate": _needs("imu", "aids"),
    "navigation.start_in_motion": _needs("begun"),
    "navigation.tilt_threshold": _needs("imu", figure="roll"),
    "navigation.height_threshold": _needs("imu", figure="height"),
    "navigation.height_gate": _needs("wild heights"),
    "navigation.gate_reset_time": _needs("gates"),
    "motion.odometry_slip": _needs("wheels"),
    "fusion.widen_vertical": _needs("imu", figure="height"),
}
EVERYWHERE = Scope()


def scope(name: str) -> Scope:
    """Where the addition with this first setting can act."""
    return SCOPES.get(name, EVERYWHERE)


CONFIGURATIONS: Mapping[str, SlamConfig] = {
    FULL: SlamConfig(),
    PAPER: SlamConfig.paper(),
    LAST_POSE: with_values(SlamConfig.paper(), {"matcher.start_estimate": "last_pose"}),
    **{addition.name: with_values(SlamConfig(), addition.values) for addition in MEASURED},
}
