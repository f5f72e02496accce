"""Settings of the scan."""

from dataclasses import dataclass
from typing import Annotated

from slam_core.config.leaves import Param


@dataclass(frozen=True, slots=True)
class ScanConfig:
    """Section IV: from a sweep to endpoints in the stabilised frame."""

    range_min: Annotated[
        float, Param("Minimum range: shorter beams are not used.", "m", 0.0, 10.0, tier="basic")
    ] = 0.4
    range_max: Annotated[
        float,
        Param(
            "Maximum range: longer beams are not used. The default leaves it to what the device says of itself.",
            "m",
            1.0,
            250.0,
            tier="basic",
        ),
    ] = 250.0
    z_min: Annotated[float, Param("Lowest endpoint used, relative to the laser.", "m", -10.0, 0.0)] = -1.0
    z_max: Annotated[float, Param("Highest endpoint used, relative to the laser.", "m", 0.0, 10.0)] = 1.0
    stabilise: Annotated[
        bool,
        Param(
            "Rotate the endpoints by the estimated roll and pitch into the stabilised frame (section IV).",
            tier="basic",
        ),
    ] = True
    deskew: Annotated[
        bool,
        Param(
            "Place each beam with the estimated pose of its own time, not with that of the whole sweep (off:"
            " the paper).",
            tier="basic",
        ),
    ] = True
    clear_range: Annotated[
        float,
        Param("A beam without a return clears the cells up to this range (0: it is not used).", "m", 0.0, 30.0),
    ] = 0.0
    smooth_noise: Annotated[
        float,
        Param(
            "A range with more noise than this, as the scans show it, is smoothed along the straight wall on which"
            " its neighbours lie (0: none is).",
            "m",
            0.0,
            1.0,
        ),
    ] = 0.05
