"""Settings of the checks and of the recovery."""

from dataclasses import dataclass
from typing import Annotated

from slam_core.config.leaves import Param


@dataclass(frozen=True, slots=True)
class TrackingConfig:
    """Checks of the match, and recovery of a lost pose."""

    check: Annotated[
        bool,
        Param(
            "Check every match, search in a window after a bad one, and keep bad ones out of the map (off:"
            " the paper).",
            tier="basic",
            title="Check each match",
        ),
    ] = True
    min_inlier_ratio: Annotated[
        float, Param("Minimum inlier ratio of a match, relative to its running mean.", "", 0.0, 1.0)
    ] = 0.65
    min_overlap: Annotated[float, Param("Minimum share of the endpoints on known cells.", "", 0.0, 1.0)] = 0.3
    unaided_mahalanobis_limit: Annotated[
        float,
        Param(
            "Mahalanobis limit of a match with slow scans alone, without an IMU and wheels: one further from the"
            " prediction is checked by a search.",
            "σ",
            1.0,
            1000.0,
        ),
    ] = 2.5
    ignore_dynamic: Annotated[
        bool,
        Param(
            "Match a scan without what may move, if the other beams fit better so: the objects in the foreground,"
            " and those in free space if the match is far from the prediction. With an IMU only the former, if the"
            " match is far from the prediction or fits badly; never with wheels alone."
        ),
    ] = True
    keep_speed: Annotated[
        bool,
        Param(
            "Without an IMU and wheels: where few beams fix a direction, match a scan where most of its beams fit"
            " along it. If these do not tell, and matches scatter by more than a robot accelerates, leave it to"
            " the mean speed before."
        ),
    ] = True
    search_distance: Annotated[float, Param("Largest translation that the search covers.", "m", 0.1, 5.0)] = 2.0
    search_angle: Annotated[float, Param("Largest rotation that the search covers.", "rad", 0.05, 3.14)] = 3.14
    lost_after: Annotated[
        int, Param("The pose counts as lost after so many scans in a row without a confirmed match.", "", 1, 1000)
    ] = 10
    relocalise: Annotated[bool, Param("Global localisation: search the whole map while the pose is lost.")] = True
    relocalise_interval: Annotated[float, Param("Time between two searches of the whole map.", "s", 0.0, 60.0)] = (
        1.0
    )
    relocalise_min_inlier_ratio: Annotated[
        float, Param("Minimum inlier ratio of a pose that such a search finds.", "", 0.3, 1.0)
    ] = 0.85
    continue_from_prediction: Annotated[
        bool,
        Param(
            "If the pose was lost outside the known map, continue the map from the prediction of inertial data or"
            " wheels."
        ),
    ] = True
