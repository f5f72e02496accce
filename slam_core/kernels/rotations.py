"""Rotations as numbers, for compiled code: a small array takes longer to get than what is in it to work out."""

from typing import Any

from numba import njit

from slam_core import geometry

product: Any = njit(inline="always")(geometry.product)
exponential: Any = njit(inline="always")(geometry.exponential)
cosines: Any = njit(inline="always")(geometry.cosines)
