"""Named configurations: the defaults, and the method of the paper without additions."""

from collections.abc import Mapping
from dataclasses import dataclass

from slam_core.config.changes import with_values
from slam_core.config.leaves import Leaves
from slam_core.config.tree import SlamConfig

Value = float | bool | str


@dataclass(frozen=True, slots=True)
class Addition:
    """Something that the defaults do beyond the paper. values: the settings that switch it off, by name."""

    title: str
    values: Mapping[str, Value]


ADDITIONS = (
    Addition("Each beam is placed by the motion during the sweep (deskewing).", {"scan.deskew": False}),
    Addition(
        "Without an IMU a sweep is placed and matched again by the motion that its match shows.",
        {"motion.deskew_refinements": 0},
    ),
    Addition("The cell behind a hit is lowered, so that walls are as sharp behind as in front.",
             {"map.factor_behind": 0.5}),
    Addition("A scan that fits worse than usual waits for a better one to be written (laser alone).",
             {"map.keyframe_max_delay": 0.0}),
    Addition("Occupied cells that beams pass are cleared, at rest as well (dynamic objects).",
             {"map.clear_interval": 0.0}),
    Addition("The predicted pose joins the cost (7) with its covariance.", {"matcher.prior_weight": 0.0}),
    Addition("The finest level keeps surfels, which the match settles on.", {"matcher.surfel_weight": 0.0}),
    Addition("A level ends when its Gauss-Newton step is short.", {"matcher.converged_step": 0.0}),
    Addition("Coarser levels take half of the beams.", {"matcher.coarse_beams": 0}),
    Addition("A match far from the prediction is compared with one that starts there.",
             {"matcher.prior_restart_sigmas": 0.0}),
    Addition("Where the shape of a scan observes a direction weakly, only the gradient across surfaces counts.",
             {"matcher.weak_observability_threshold": 0.0}),
    Addition("An unobservable direction keeps its predicted position.", {"matcher.degeneracy_threshold": 0.0}),
    Addition("Each match is checked; a rejected one is searched for again and is not written.",
             {"tracking.check": False, "tracking.relocalise": False, "tracking.continue_from_prediction": False}),
    Addition("A slow laser alone: a match far from the prediction is compared with a search.",
             {"tracking.unaided_mahalanobis_limit": 1000.0}),
    Addition("A lost robot is searched for in the whole map.", {"tracking.relocalise": False}),
    Addition("A robot that got lost outside of the map continues it from the prediction.",
             {"tracking.continue_from_prediction": False}),
    Addition("A base that stands still has zero velocity, and its gyros measure their bias.",
             {"aiding.standstill": False}),
    Addition("Aiding measurements far from the prediction are rejected.",
             {"aiding.gate": 0.0, "navigation.height_gate": 0.0, "motion.odometry_gate": 0.0}),
    Addition("The noise of wheel velocities grows with the velocity (slip).", {"motion.odometry_slip": 0.0}),
    Addition("Without an IMU, covariance intersection widens only what depends on the observed pose.",
             {"motion.observed_only": False}),
    Addition("Covariance intersection does not widen height, vertical velocity and their bias.",
             {"fusion.widen_vertical": True}),
)  # fmt: skip

PAPER: Mapping[str, Value] = {name: value for addition in ADDITIONS for name, value in addition.values.items()}
PRESETS: Mapping[str, Mapping[str, Value]] = {"default": {}, "paper": PAPER}


def preset_values(name: str) -> dict[str, Value]:
    """The values of a preset of every setting in which presets differ; KeyError for a name that is none."""
    config = Leaves(preset(name))
    return {setting: config[setting].value for setting in PAPER}


def preset(name: str) -> SlamConfig:
    """The configuration of a preset; KeyError for a name that is none."""
    return with_values(SlamConfig(), PRESETS[name])
