"""Settings of the map."""

from dataclasses import dataclass
from typing import Annotated

from slam_core.config.leaves import Param


@dataclass(frozen=True, slots=True)
class MapConfig:
    """Sections IV-A and IV-C: the levels of occupancy grids, and which scans are written into them."""

    resolution: Annotated[
        float, Param("Cell length of the finest level.", "m", 0.01, 1.0, restart=True, tier="basic")
    ] = 0.05
    size: Annotated[
        int,
        Param(
            "Cells along a side of the finest level's window at the start, in whole tiles. The window moves with"
            " the robot and grows to the range of the laser; a larger one takes longer to move.",
            "cells",
            64,
            8192,
            restart=True,
        ),
    ] = 1024
    grow: Annotated[
        bool,
        Param("Move and enlarge the map's window when a beam reaches its edge (off: the beam is cut there)."),
    ] = True
    limit: Annotated[
        float,
        Param(
            "Memory limit of the map: its window, of half of this at most, and the tiles that were seen outside of"
            " it. The map does not grow beyond it.",
            "MB",
            1.0,
            14336.0,
            log=True,
        ),
    ] = 1024.0
    levels: Annotated[
        int,
        Param(
            "Number of levels. Each coarser level has cells of twice the length (section IV-C).",
            "",
            1,
            6,
            restart=True,
            tier="basic",
        ),
    ] = 3
    start_x: Annotated[
        float, Param("Start position as a fraction of the map's width.", "", 0.0, 1.0, restart=True)
    ] = 0.5
    start_y: Annotated[
        float, Param("Start position as a fraction of the map's height.", "", 0.0, 1.0, restart=True)
    ] = 0.5
    factor_free: Annotated[
        float,
        Param(
            "Each scan adds ln(p / (1 - p)) with this p to the log-odds of a cell that a beam crosses.",
            "",
            0.05,
            0.49,
            tier="basic",
        ),
    ] = 0.4
    factor_occupied: Annotated[
        float,
        Param(
            "Each scan adds ln(p / (1 - p)) with this p to the log-odds of a cell that a beam ends in.",
            "",
            0.51,
            0.99,
            tier="basic",
        ),
    ] = 0.9
    factor_behind: Annotated[
        float,
        Param(
            "The cell behind an endpoint takes the free step too, down to this probability, on the finest"
            " level (0.5: off, the paper).",
            "",
            0.01,
            0.5,
        ),
    ] = 0.15
    wall_gap: Annotated[
        float,
        Param(
            "Where a beam grazes a straight wall, the wall between its endpoint and the next is written, too, if"
            " they lie no further apart than this, or than twice this if the beams of the scanner are more than"
            " 0.9 degrees apart (0: off, the paper).",
            "m",
            0.0,
            10.0,
        ),
    ] = 3.0
    log_odds_min: Annotated[float, Param("Lower bound of a cell's log-odds.", "", -50.0, -0.5)] = -50.0
    log_odds_max: Annotated[float, Param("Upper bound of a cell's log-odds.", "", 0.5, 50.0)] = 50.0
    update: Annotated[
        bool,
        Param("Write scans into the map (off: the map stays as it is, and the pose is still followed in it)."),
    ] = True
    update_distance: Annotated[
        float,
        Param(
            "A scan is written into the map when the robot has moved this far since the last one.",
            "m",
            0.0,
            5.0,
            tier="first",
        ),
    ] = 0.4
    update_angle: Annotated[
        float,
        Param(
            "A scan is written into the map when the robot has turned this far since the last one.",
            "rad",
            0.0,
            3.14,
            tier="first",
        ),
    ] = 0.06
    keyframe_max_delay: Annotated[
        float,
        Param(
            "With scans alone, a keyframe in a turn that fits worse than the running mean is delayed by this time"
            " at most (0: off, the paper).",
            "s",
            0.0,
            10.0,
        ),
    ] = 0.5
    appearance_delay: Annotated[
        float,
        Param(
            "An object that appears in free space is written once it has stayed there for this time, so that"
            " people who pass are not (0: off, the paper).",
            "s",
            0.0,
            9.0,
        ),
    ] = 3.0
    clear_interval: Annotated[
        float,
        Param(
            "Interval of dynamic-object removal, which clears occupied cells that beams pass (0: off, the paper).",
            "s",
            0.0,
            60.0,
        ),
    ] = 0.25
