"""Named configurations: the defaults, and the method of the paper."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from slam_core.config.changes import with_values
from slam_core.config.leaves import Leaves, leaves
from slam_core.config.tree import SlamConfig

Value = float | bool | str
Preset = Literal["default", "paper"]


@dataclass(frozen=True, slots=True)
class Addition:
    """Something that the defaults do beyond the paper. values: the settings that switch it off, by name."""

    title: str
    values: Mapping[str, Value]

    @property
    def name(self) -> str:
        """Its first setting."""
        return next(iter(self.values))


ADDITIONS = (
    Addition(
        "Places each beam with the estimated pose of its own time (deskewing).",
        {"scan.deskew": False},
    ),
    Addition(
        "Smooths ranges of a laser with much noise along straight walls.",
        {"scan.smooth_noise": 0.0},
    ),
    Addition(
        "Without an IMU, deskews and matches a sweep again with the velocity that its match gives.",
        {"motion.deskew_refinements": 0},
    ),
    Addition(
        "Lowers the cell behind an endpoint too, so that walls do not grow thicker away from the laser.",
        {"map.factor_behind": 0.5},
    ),
    Addition(
        "Writes the wall between endpoints of beams that graze it: cells of it alone look like landmarks.",
        {"map.wall_gap": 0.0},
    ),
    Addition(
        "With scans alone, delays a keyframe in a turn that fits worse than the running mean.",
        {"map.keyframe_max_delay": 0.0},
    ),
    Addition(
        "Writes an object that appears in free space once it has stayed there: people who pass are no landmarks.",
        {"map.appearance_delay": 0.0},
    ),
    Addition(
        "Clears occupied cells that beams pass, at rest too (dynamic-object removal).",
        {"map.clear_interval": 0.0},
    ),
    Addition(
        "Adds the predicted pose with its covariance to the cost of eq. (7).",
        {"matcher.prior_weight": 0.0},
    ),
    Addition(
        "Weighs a prediction by wheels more, unless the walls of the map contradict it.",
        {"matcher.wheels_weight": 0.0},
    ),
    Addition(
        "Keeps surfels on the finest level and lets the match settle on them.",
        {"matcher.surfel_weight": 0.0},
    ),
    Addition(
        "Matches a scan again without the endpoints on walls seen from behind: their other side is not mapped.",
        {"matcher.back_face_share": 1.0},
    ),
    Addition(
        "Ends a level when the Gauss-Newton step is short.",
        {"matcher.converged_step": 0.0},
    ),
    Addition(
        "Compares a match far from the prediction with one that starts at the prediction.",
        {"matcher.prior_restart_sigmas": 0.0},
    ),
    Addition(
        "Leaves a degenerate direction to the prediction, and keeps the drift along it in the covariance.",
        {"matcher.degeneracy_threshold": 0.0},
    ),
    Addition(
        "Checks each match, searches in a window after a bad one, and keeps bad ones out of the map.",
        {"tracking.check": False},
    ),
    Addition(
        "Searches the whole map while the pose is lost (global localisation).",
        {"tracking.relocalise": False},
    ),
    Addition(
        "Continues the map from the prediction when the pose was lost outside the known map.",
        {"tracking.continue_from_prediction": False},
    ),
    Addition(
        "Detects standstill in the inertial data: zero velocity, and the gyroscopes measure their biases.",
        {"aiding.standstill": False},
    ),
    Addition(
        "Begins the map of a base that moves at the start once scans have confirmed attitude and velocity.",
        {"navigation.start_in_motion": False},
    ),
    Addition(
        "Corrects roll and pitch by the measured gravity while they are uncertain.",
        {"navigation.tilt_threshold": 1.0},
    ),
    Addition(
        "Holds the height at that of the start while it is uncertain.",
        {"navigation.height_threshold": 100.0},
    ),
    Addition(
        "Rejects heights far from the prediction.",
        {"navigation.height_gate": 0.0},
    ),
    Addition(
        "Rejects other aiding measurements far from the prediction.",
        {"aiding.gate": 0.0},
    ),
    Addition(
        "Adds a share of the wheel velocity to its noise (slip).",
        {"motion.odometry_slip": 0.0},
    ),
    Addition(
        "Does not widen the covariance of height, vertical velocity and bias at a match.",
        {"fusion.widen_vertical": True},
    ),
)
"""Each can be switched off alone; docs/beyond-the-paper.md has what it is worth."""

PAPER: Mapping[str, Value] = {name: value for addition in ADDITIONS for name, value in addition.values.items()}
PRESETS: Mapping[Preset, Mapping[str, Value]] = {
    "default": {name: leaf.value for name, leaf in Leaves(SlamConfig()).items() if name in PAPER},
    "paper": PAPER,
}
"""The same settings in each, so that one preset can follow another on a changed configuration."""


def preset(name: Preset) -> SlamConfig:
    """The defaults with the values of a preset."""
    return with_values(SlamConfig(), PRESETS[name])


def nearest_preset(config: SlamConfig) -> tuple[Preset, dict[str, Value]]:
    """The preset from which a configuration differs in the fewest settings, and its values of these, by name."""
    differing = {name: differences(config, preset(name)) for name in PRESETS}
    return min(differing.items(), key=lambda item: len(item[1]))


def differences(config: SlamConfig, other: SlamConfig) -> dict[str, Value]:
    """The values of `other`, by name, of the settings in which `config` differs from it."""
    pairs = zip(leaves(config), leaves(other), strict=True)
    return {theirs.name: theirs.value for ours, theirs in pairs if ours.value != theirs.value}
