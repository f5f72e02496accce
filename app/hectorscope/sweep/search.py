"""Settings that are searched for: a seeded quasi-random sequence, and successive halving of what it gives."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from hectorscope.sweep.spec import RunSpec
from hectorscope.sweep.vary import Axis, VaryError

PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53)
KEEP = 3  # one setting in so many goes on to the next rung
RUNGS = (1 / 9, 1 / 3, 1.0)  # shares of the recordings' time


def quasi_random(axes: Sequence[Axis], count: int, seed: int) -> Iterator[Mapping[str, Any]]:
    """So many points of the Halton sequence, one base an axis, moved by a seeded shift that wraps around.

    VaryError for more axes than there are bases, or none.
    """
    if not 0 < len(axes) <= len(PRIMES):
        raise VaryError(f"--search varies {len(axes)} settings: give 1 to {len(PRIMES)} by --vary")
    shifts = np.random.default_rng(seed).random(len(axes))
    for k in range(1, count + 1):
        shares = [(radical_inverse(k, base) + shift) % 1.0 for base, shift in zip(PRIMES, shifts, strict=False)]
        yield {axis.name: axis.at(float(share)) for axis, share in zip(axes, shares, strict=False)}


def radical_inverse(k: int, base: int) -> float:
    """The digits of k in a base, mirrored behind the point: element k of the van der Corput sequence."""
    inverse, digit = 0.0, 1.0 / base
    while k:
        k, remainder = divmod(k, base)
        inverse += remainder * digit
        digit /= base
    return inverse


def rungs(count: int) -> list[tuple[float, int]]:
    """Share of the time and number of settings, a pair for each rung; few settings have fewer rungs."""
    steps = [(share, max(1, count // KEEP**k)) for k, share in enumerate(RUNGS)]
    return [first for first, after in pairwise(steps) if first[1] > after[1]] + steps[-1:]


def standing(specs: Sequence[RunSpec], costs: Mapping[str, float]) -> list[str]:
    """Setting keys from the best on: by the mean rank over the recordings, then by their order.

    costs: of each run by its key; what has none, or failed, is behind all others of its recording.
    """
    ranks: dict[str, list[float]] = {}
    for path in dict.fromkeys(spec.path for spec in specs):
        own = [spec for spec in specs if spec.path == path]
        found = np.array([costs.get(spec.key, np.inf) for spec in own])
        for spec, cost in zip(own, found, strict=True):
            rank = float(np.sum(found < cost) + 0.5 * (np.sum(found == cost) - 1))
            ranks.setdefault(spec.setting_key, []).append(rank)
    return sorted(ranks, key=lambda key: float(np.mean(ranks[key])))
