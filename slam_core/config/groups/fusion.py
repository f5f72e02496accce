"""Settings of the fusion."""

from dataclasses import dataclass
from typing import Annotated, Literal

from slam_core.config.leaves import Param

FusionMethod = Literal["fixed", "trace", "determinant", "kalman"]


@dataclass(frozen=True, slots=True)
class FusionConfig:
    """Section V-B: covariance intersection of the filter with the match."""

    method: Annotated[
        FusionMethod,
        Param(
            "Covariance intersection with the fixed omega (the paper), with the omega of least trace or"
            " determinant, or a Kalman update, which assumes independent errors.",
            tier="basic",
            title="Fusion method",
        ),
    ] = "fixed"
    omega: Annotated[
        float,
        Param(
            "Weight omega of the match in the covariance intersection, eqs. (16)-(20).",
            "",
            0.001,
            0.999,
            tier="first",
            title="Weight of the match, ω",
        ),
    ] = 0.02
    widen_vertical: Annotated[
        bool,
        Param(
            "A match widens by 1 / (1 - omega) also the covariance of height, vertical velocity and biases"
            " (on: eq. (18))."
        ),
    ] = False
    gate: Annotated[
        float,
        Param(
            "With an IMU, the Mahalanobis limit of a match: one further from the prediction is not fused (0:"
            " off).",
            "σ",
            0.0,
            100.0,
            title="Gate of the match",
        ),
    ] = 0.0
