"""What a laser scanner is by its data sheet."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True)
class Scanner:
    """Metres, radians, seconds; what the paper's scanner has, a Hokuyo UTM-30LX, unless it is said otherwise."""

    field: float = float(np.radians(270.0))
    range_min: float = 0.1
    range_max: float = 30.0
    sigma_near: float = 0.01
    sigma_near_to: float = 10.0  # from there the noise grows to
    sigma_far: float = 0.03  # at range_max
    resolution: float = 0.001
    dropout: float = 0.003  # share of beams that give nothing
    latency: float = 0.002


UTM30LX = Scanner()
"""The scanner of the paper."""
LMS = Scanner(field=float(np.radians(180.0)), range_max=50.0, sigma_far=0.04, resolution=0.01)
"""A scanner that looks ahead only, and far: half a turn, 50 m, whole centimetres."""
