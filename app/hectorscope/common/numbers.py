"""Whole numbers of a file may have any length: what of them a float or a time can hold."""

import math


def as_float(value: float) -> float:
    """The number; infinite where it is a whole one that no float holds."""
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def is_time_ns(value: int) -> bool:
    """Whether it fits into 64 bits, as all times do."""
    return -(2**63) <= value < 2**63
