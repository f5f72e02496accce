"""What a person may choose about a simulated recording."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from slam_core.errors import SlamError

Extra = Literal["gps", "compass", "rangefinder"]
ScenarioName = Literal["arena", "littoral", "handheld", "rooms", "corridor", "people", "glass", "offices"]


class SimulationError(SlamError):
    """A choice about the simulation is out of range or cannot be written."""


_RANGES: dict[str, tuple[float, float, str]] = {
    "duration": (3.0, 36_000.0, " s"),
    "begin": (0.0, 36_000.0, " s"),
    "scan_rate": (1.0, 100.0, " Hz"),
    "beams": (2, 10000, ""),
    "speed": (0.1, 5.0, ""),
    "sway": (0.0, 45.0, " deg"),
    "sway_frequency": (0.05, 5.0, " Hz"),
    "noise": (0.0, 100.0, ""),
    "gps_outage": (0.0, 3600.0, " s"),
    "seed": (0, 2**32 - 1, ""),
}


@dataclass(frozen=True, kw_only=True)
class SceneOptions:
    """How a scene is driven and measured; None keeps what the scene itself prefers."""

    duration: float | None = None
    """Length of the drive in seconds; None: the scene's own."""
    begin: float = 0.0
    """Seconds of the drive that are left out at its start: the recording begins in motion."""
    scan_rate: float = 40.0
    """Revolutions of the laser per second; a sweep of 270 degrees takes three quarters of one."""
    beams: int = 1081
    """Beams of one sweep, spread over the field of the scanner."""
    beam_timing: bool = True
    """Each beam leaves at its own time; otherwise the whole sweep is taken at its stamp."""
    speed: float = 1.0
    """Factor on the scene's own speed."""
    sway: float | None = None
    """Largest roll and pitch of the swaying motion, degrees; None: the scene's own."""
    sway_frequency: float | None = None
    """Frequency of the swaying motion, Hz; None: the scene's own."""
    noise: float = 1.0
    """Factor on all noise, biases and drop-outs; 0 measures exactly."""
    people: bool = True
    """Whether people walk about, where the scene has any."""
    imu: bool = True
    """Whether there is an inertial unit."""
    extras: tuple[Extra, ...] | None = None
    """What is carried besides laser, inertial unit and barometer; None: the scene's own."""
    gps_outage: float | None = None
    """Seconds without satellites in the middle of the drive; None: the scene's own."""
    seed: int = 1
    """Seed of the noise and of who walks where: the same seed gives the same bytes."""

    def __post_init__(self) -> None:
        """Refuse values out of range: SimulationError names the option, the value and the range."""
        for name, (low, high, unit) in _RANGES.items():
            value = getattr(self, name)
            if value is not None and not (math.isfinite(value) and low <= value <= high):
                raise SimulationError(f"{name} is {value:g}{unit}: give {low:g} to {high:g}{unit}")


@dataclass(frozen=True, kw_only=True)
class SimulateOptions(SceneOptions):
    """A scene, how it is measured, and the recording that is written."""

    scenario: ScenarioName
    """Which scene."""
    out: Path
    """Recording to write: NAME.bag (ROS 1), NAME.mcap (rosbag2), or a folder (rosbag2, sqlite3)."""
