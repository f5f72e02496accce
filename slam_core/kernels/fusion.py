"""Sections V-A and V-B in compiled form: one correction of the state, its gate, and the weight it gets.

State and errors are laid out as in slam_core.kernels.navigation.
"""

import math

import numpy as np
from numba import njit

from slam_core import geometry
from slam_core.kernels import INNER
from slam_core.kernels.linear import (
    add,
    cholesky,
    fill,
    fill_estimate,
    gain,
    is_sound,
    multiply,
    sandwich,
    solve_lower,
    squared_length,
)
from slam_core.kernels.navigation import ERRORS, inject
from slam_core.kernels.rotations import cosines
from slam_core.kernels.structures import FusionRule
from slam_core.measurements import Float64s, Int64s

FIXED, MIN_TRACE, MIN_DETERMINANT, KALMAN = range(4)
LIGHTEST, HEAVIEST = 1e-6, 0.999
NONE = np.zeros(0, np.int64)
VERTICAL = np.array([5, 8, 14])  # errors of height, of the velocity up, and of the accelerometer that measures it
NONE.setflags(write=False)  # as kernels see it: else what takes it would be compiled once more for other callers
GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)

_heading_gradient = njit(error_model="numpy")(geometry.heading_gradient)


@njit(cache=True, error_model="numpy")
def correct(
    x: Float64s,
    P: Float64s,
    innovation: Float64s,
    C: Float64s,
    R: Float64s,
    bound: float,
    better: Float64s,
    reduced: Float64s,
    S: Float64s,
) -> float:
    """One Kalman update behind a gate: nu^T S^-1 nu.

    Where that passes `bound`, or the numbers do not bear the update (it is NaN then), x and P stay as they were.
    better (19,), reduced (15, 15) and S (m, m) take x, P and C P C^T + R: to return an array takes longer than to
    fill it.
    """
    CP = multiply(C, P)
    fill(S, add(multiply(C, CP.T), R, 1.0))
    nis = squared_length(S, innovation)
    fill_estimate(better, reduced, x, P)
    if not nis <= bound:
        return nis
    error, spread = gain(P, CP, S, innovation)
    return nis if _put_right(x, error, spread, better, reduced) else math.nan


@njit(**INNER)
def _put_right(x: Float64s, error: Float64s, spread: Float64s, better: Float64s, reduced: Float64s) -> bool:
    """Take x with an error put right, and the covariance after that, if the numbers bear it."""
    moved = inject(x, error)
    sound = is_sound(moved, spread)
    if sound:
        fill_estimate(better, reduced, moved, spread)
    return sound


@njit(cache=True, error_model="numpy")
def correct_planar(
    x: Float64s,
    P: Float64s,
    match: tuple[Float64s, Float64s],
    fusion: FusionRule | tuple[int, float, Float64s, bool],
    bound: float,
    output: tuple[Float64s, Float64s, Float64s, Float64s],
) -> float:
    """`fuse_part` by a match xi (3,) with R, C x = (p_x, p_y, psi), behind a gate: nu^T S^-1 nu as of `correct`.

    fusion: the fields of `FusionRule`. output: x (19,) and P (15, 15) after it, innovation (3,) and S (3, 3).
    """
    (xi, R), (better, reduced, innovation, S) = match, output
    rule, omega, unobservable, widen_vertical = fusion
    innovation[0], innovation[1] = xi[0] - x[4], xi[1] - x[5]
    turn = xi[2] - 2.0 * math.atan2(x[3], x[0])
    innovation[2] = turn - 2.0 * math.pi * round(turn / (2.0 * math.pi))
    C = planar_observer(x)
    fill(S, add(sandwich(C, P), R, 1.0))
    fill_estimate(better, reduced, x, P)
    nis = squared_length(S, innovation)
    if not nis <= bound:
        return nis
    held = np.zeros((2, ERRORS))
    for i in range(2):
        held[0, 3 + i] = held[1, 6 + i] = unobservable[i]
    spared = NONE if widen_vertical else VERTICAL
    error, spread = fuse_part(P, C, R, innovation, rule, omega, unobservable, held, spared)
    return nis if _put_right(x, error, spread, better, reduced) else math.nan


@njit(cache=True, error_model="numpy")
def planar_observer(x: Float64s) -> Float64s:
    """The observer matrix C (3, 15) of eqs. (16)-(20): how the planar pose follows the errors of the state."""
    C = np.zeros((3, ERRORS))
    C[0, 3] = C[1, 4] = 1.0
    slope = _heading_gradient(x[:4])
    for i in range(3):
        C[2, i] = slope[i]
    return C


@njit(cache=True, error_model="numpy")
def planar_estimate(x: Float64s, P: Float64s, mean: Float64s, covariance: Float64s) -> None:
    """C x of eq. (19), position in the plane and heading, into mean (3,); C P C^T into covariance (3, 3)."""
    psi = 2.0 * math.atan2(x[3], x[0])
    mean[0], mean[1], mean[2] = x[4], x[5], psi - 2.0 * math.pi * round(psi / (2.0 * math.pi))
    fill(covariance, sandwich(planar_observer(x), P))


@njit(cache=True, error_model="numpy")
def body_velocity(x: Float64s, n: int) -> tuple[Float64s, Float64s]:
    """The first n of R^T v, and how they follow the errors of the state: (n,) and (n, 15)."""
    R, v = cosines(x), x[7:10]
    predicted, C = np.zeros(n), np.zeros((n, ERRORS))
    for i in range(n):
        for j in range(3):
            a, b = (j + 1) % 3, (j + 2) % 3
            predicted[i] += R[3 * j + i] * v[j]
            C[i, j] = R[3 * a + i] * v[b] - R[3 * b + i] * v[a]
            C[i, 6 + j] = R[3 * j + i]
    return predicted, C


@njit(cache=True, error_model="numpy", inline="always")
def fuse_part(
    P: Float64s,
    C: Float64s,
    R: Float64s,
    innovation: Float64s,
    rule: int,
    omega: float,
    unobservable: Float64s,
    held: Float64s,
    spared: Int64s,
) -> tuple[Float64s, Float64s]:
    """Eqs. (18)-(20), or the Kalman update, on a part of P: see `covariance_intersection.intersect`.

    What is held counts as any other error.
    """
    # Called in one place, as what is called is compiled into this function at each.
    rest, kept = P, np.zeros((0, len(P)))
    if unobservable[0] != 0.0 or unobservable[1] != 0.0:
        across, kept_part = np.zeros((2, 3)), np.empty(2)
        across[0, 0], across[0, 1], across[1, 2] = -unobservable[1], unobservable[0], 1.0
        kept_part[0] = unobservable[0] * innovation[1] - unobservable[1] * innovation[0]
        kept_part[1] = innovation[2]
        innovation = kept_part
        C, R = multiply(across, C), sandwich(across, R)
        kept = explained_by(P, held)
        rest = add(P.copy(), multiply(kept.T.copy(), kept), -1.0)
    error, reduced = innovation, P
    for k in range(-1, len(kept)):
        difference = innovation if k < 0 else multiply(C, kept[k].copy().reshape(-1, 1)).reshape(-1)
        shift, spread = _intersect(rest, C, R, difference, rule, omega, spared)
        if k < 0:
            error, reduced = shift, spread
        else:
            for j in range(len(shift)):
                kept[k, j] -= shift[j]
    if len(kept):
        reduced = add(reduced, multiply(kept.T.copy(), kept), 1.0)
    return error, reduced


@njit(error_model="numpy", inline="always")
def _intersect(
    P: Float64s, C: Float64s, R: Float64s, innovation: Float64s, rule: int, omega: float, spared: Int64s
) -> tuple[Float64s, Float64s]:
    CP = multiply(C, P)
    projected = multiply(C, CP.T)
    if rule in (MIN_TRACE, MIN_DETERMINANT):
        omega, rule = lightest(P, CP, projected, R, rule == MIN_TRACE), FIXED
    weight, share = (1.0, 1.0) if rule == KALMAN else ((1.0 - omega) / omega, 1.0 - omega)
    error, reduced = gain(P, CP, add(projected, R, weight), innovation)
    for i in range(len(reduced)):
        for j in range(len(reduced)):
            reduced[i, j] /= share
    if rule == FIXED:
        _spare(reduced, spared, math.sqrt(1.0 - omega))
    return error, reduced


@njit(**INNER)
def _spare(P: Float64s, spared: Int64s, share: float) -> None:
    """Take the widening back from some errors, in place: D P D with 1 or the share on the diagonal of D."""
    for i in spared:
        for j in range(len(P)):
            P[i, j] *= share
            P[j, i] *= share


@njit(cache=True, error_model="numpy")
def explained_by(P: Float64s, B: Float64s) -> Float64s:
    """W with W^T W = P B^T (B P B^T)^-1 B P: what of P depends on B x; the rest remains once that is known."""
    BP = multiply(B, P)
    return solve_lower(cholesky(multiply(B, BP.T)), BP)


@njit(cache=True, error_model="numpy")
def kalman(P: Float64s, C: Float64s, R: Float64s, innovation: Float64s) -> tuple[Float64s, Float64s]:
    """The Kalman update: the correction to add to the state, and P after it."""
    CP = multiply(C, P)
    return gain(P, CP, add(multiply(C, CP.T), R, 1.0), innovation)


@njit(cache=True, error_model="numpy")
def lightest(P: Float64s, CP: Float64s, projected: Float64s, R: Float64s, trace: bool) -> float:
    """The omega that makes P+ of eq. (18) smallest, by golden section: both measures are convex in omega.

    The trace is of P+ relative to the variances of P, as the errors have different units.
    """
    n, m = len(P), len(R)
    G = np.zeros((m, m))
    for i in range(m):
        for j in range(m):
            for k in range(n):
                G[i, j] += CP[i, k] * CP[j, k] / P[k, k]
    low, high = LIGHTEST, HEAVIEST
    a, b = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    at_a = at_b = math.inf
    known, here = 0, a  # the size is worked out in one place, as it is compiled into this function at each
    while known < 2 or high - low > 1e-3:
        if known >= 2 and at_a < at_b:
            high, b, at_b = b, a, at_a
            a = here = high - GOLDEN * (high - low)
        elif known >= 2:
            low, a, at_a = a, b, at_b
            b = here = low + GOLDEN * (high - low)
        size = _size(here, n, G, projected, R, trace)
        if here == a:
            at_a = size
        else:
            at_b = size
        known, here = known + 1, b
    return low if low == LIGHTEST else 0.5 * (low + high)


@njit(error_model="numpy", inline="always")
def _size(omega: float, n: int, G: Float64s, projected: Float64s, R: Float64s, trace: bool) -> float:
    """Trace, or logarithm of the determinant, of P+ for a weight; but for what does not depend on it."""
    m = len(R)
    both = np.empty((m, m))
    for i in range(m):
        for j in range(m):
            both[i, j] = (1.0 - omega) * R[i, j] + omega * projected[i, j]
    L = cholesky(both)
    if trace:
        gained = 0.0
        half = solve_lower(L, G)
        full = solve_lower(L, half.T.copy())
        for i in range(m):
            gained += full[i, i]
        return (n - omega * gained) / (1.0 - omega)
    size = (m - n) * math.log(1.0 - omega)
    for i in range(m):
        size -= 2.0 * math.log(L[i, i])
    return size
