"""How a number becomes a slider: linear with a round step, or logarithmic in decades."""

import math
from dataclasses import dataclass

from slam_core.config import Leaf

LINEAR_STEPS = 400  # a slider is about that many pixels wide
DECADE_STEP = 0.01  # 2.3 % of the value
DIGITS = 3  # of a value set by a logarithmic slider


@dataclass(frozen=True, slots=True)
class Scale:
    """A slider's range in slider units (log10 of the value where `log`) and the step of a nudge."""

    low: float
    high: float
    step: float
    log: bool
    integer: bool

    def to_slider(self, value: float) -> float:
        """Where the slider stands for `value`, inside its range."""
        position = math.log10(max(value, 10.0**self.low)) if self.log else value
        position = min(max(position, self.low), self.high)
        return round(position) if self.integer else position

    def from_slider(self, position: float) -> float:
        """The value at a position, inside the range; to three digits where `log`."""
        position = min(max(position, self.low), self.high)
        if not self.log:
            return position
        value = float(f"{math.pow(10.0, position):.{DIGITS}g}")
        return min(max(value, math.pow(10.0, self.low)), math.pow(10.0, self.high))


def scale_of(leaf: Leaf) -> Scale:
    """The slider for one number of the configuration, which must state its range."""
    low, high = leaf.param.low, leaf.param.high
    assert low is not None and high is not None, f"{leaf.name} states no range"
    if leaf.param.log:
        return Scale(math.log10(low), math.log10(high), DECADE_STEP, log=True, integer=False)
    if leaf.type is int:
        return Scale(int(low), int(high), 1, log=False, integer=True)
    return Scale(low, high, round_step((high - low) / LINEAR_STEPS), log=False, integer=False)


def round_step(wanted: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above `wanted`."""
    power = math.pow(10.0, math.floor(math.log10(wanted)))
    mantissa = max(m for m in (1, 2, 5) if m * power <= wanted * (1 + 1e-9))
    return float(f"{mantissa * power:.1g}")
