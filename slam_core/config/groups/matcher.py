"""Settings of the scan matcher."""

from dataclasses import dataclass
from typing import Annotated, Literal

from slam_core.config.leaves import Param

StartEstimate = Literal["filter", "velocity", "last_pose"]
CovarianceMethod = Literal["hessian", "sampled"]


@dataclass(frozen=True, slots=True)
class MatcherConfig:
    """Section IV-B: Gauss-Newton scan matching, and its covariance."""

    iterations_coarse: Annotated[
        int, Param("Gauss-Newton iterations on each coarser level, eq. (12).", "", 1, 30, tier="basic")
    ] = 4
    iterations_fine: Annotated[
        int, Param("Gauss-Newton iterations on the finest level, eq. (12).", "", 1, 60, tier="basic")
    ] = 6
    converged_step: Annotated[
        float,
        Param(
            "A level ends when a Gauss-Newton step is shorter than this; a coarser level also when it is"
            " shorter than 1/20 of its cells (0: off, the paper).",
            "m",
            0.0,
            0.05,
        ),
    ] = 0.0005
    prior_restart_sigmas: Annotated[
        float,
        Param(
            "If the match is further than this from the prediction, the finest level is matched again from"
            " the prediction, and the result with the lower cost is used (0: off, the paper).",
            "σ",
            0.0,
            100.0,
        ),
    ] = 3.0
    sigma: Annotated[
        float,
        Param(
            "Scale sigma of the match covariance R = sigma^2 H^-1, eq. (15).",
            "",
            0.001,
            10.0,
            log=True,
            tier="first",
            title="Scale of the match covariance, σ",
        ),
    ] = 0.2
    covariance: Annotated[
        CovarianceMethod,
        Param(
            "Covariance of the match: from the Hessian, eq. (15), or from samples around the match (section IV-B)."
        ),
    ] = "hessian"
    surfel_weight: Annotated[
        float,
        Param(
            "Weight of the squared distances between endpoints and surfels on the finest level (0: off, the"
            " paper).",
            "",
            0.0,
            20.0,
        ),
    ] = 5.0
    back_face_share: Annotated[
        float,
        Param(
            "If more than this share of the endpoints lies on walls seen from behind, the scan is matched again"
            " without these endpoints, and the result with the lower cost is used (1: off, the paper).",
            "",
            0.0,
            1.0,
        ),
    ] = 0.05
    degeneracy_threshold: Annotated[
        float,
        Param(
            "If less than this share of the beams fixes a direction, match and fusion leave it to the"
            " prediction (0: off, the paper).",
            "",
            0.0,
            0.2,
        ),
    ] = 0.005
    prior_weight: Annotated[
        float,
        Param(
            "Weight w of the prediction (xi_0, P): w (xi - xi_0)^T P^-1 (xi - xi_0) is added to eq. (7) in"
            " units of sigma^2 (0: off, the paper).",
            "",
            0.0,
            10.0,
        ),
    ] = 1.0
    wheels_weight: Annotated[
        float,
        Param(
            "The same of a prediction by wheels, unless the walls of the map contradict it: then, and if this is"
            " 0, prior_weight counts.",
            "",
            0.0,
            100.0,
        ),
    ] = 10.0
    start_estimate: Annotated[
        StartEstimate,
        Param(
            "Start of the match (section V-B): the predicted pose (filter), the last match moved by the"
            " predicted motion (velocity), or the last match (last_pose).",
        ),
    ] = "filter"
