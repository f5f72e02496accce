"""The chi-square distribution: how large a normalised innovation squared may be by chance."""

import math
from functools import lru_cache


def tail(value: float, dimension: int) -> float:
    """Probability that the squared length of a standard normal vector (dimension,) exceeds `value`."""
    half = 0.5 * value
    odd = dimension % 2
    total = math.erfc(math.sqrt(half)) if odd else 0.0
    for k in range(dimension // 2):
        power = k + 0.5 * odd
        total += (
            math.exp(power * math.log(half) - half - math.lgamma(power + 1.0))
            if half > 0.0
            else float(power == 0.0)
        )
    return total


def quantile(probability: float, dimension: int) -> float:
    """The value whose `tail` is this probability, by bisection."""
    low, high = 0.0, 1.0
    while tail(high, dimension) > probability:
        high *= 2.0
    while high - low > 1e-12 * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if tail(middle, dimension) > probability else (low, middle)
    return high


@lru_cache(maxsize=64)
def bound(gate: float, dimension: int) -> float:
    """Bound of a squared length (dimension,) that chance exceeds as seldom as `gate` sigmas in one dimension.

    A gate of 0 is open: inf. The square of the gate where the probability is less than a float can hold.
    """
    if gate <= 0.0:
        return math.inf
    return max(gate**2, quantile(math.erfc(gate / math.sqrt(2.0)), dimension))
