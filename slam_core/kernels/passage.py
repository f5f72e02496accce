"""The belief carried through recorded samples in one call; state, covariance and model as in `.navigation`.

stamps: (n,) nanoseconds. samples: (n, 7) input u, and a squared noise density that is added to the gyros'. They
count from `begin` to `end`; the first is not later than where one begins. Between two samples their mean holds,
after the last it alone, over a gap nothing: `blind` is the model there.
"""

import math

import numpy as np
from numba import njit

from slam_core import geometry
from slam_core.kernels.navigation import ERRORS, STATES, advance, move
from slam_core.measurements import Float64s, Int64s

# Between two inertial samples further apart than this, or this long after the last, the motion is unknown.
MAX_GAP_NS = 200_000_000
BLIND_STEP = 0.05  # s
BLIND_SPAN = 10.0  # s, after which nothing more can be forgotten

_matrix = njit(error_model="numpy")(geometry.rotation_matrix)


@njit(cache=True, error_model="numpy")
def predict(
    x: Float64s,
    P: Float64s,
    from_ns: int,
    to_ns: int,
    stamps: Int64s,
    samples: Float64s,
    begin: int,
    end: int,
    model: Float64s,
    blind: Float64s,
    bounds: Float64s,
) -> tuple[Float64s, Float64s]:
    """The belief of one instant at a later one."""
    k = begin + int(np.searchsorted(stamps[begin:end], from_ns, side="right"))
    while from_ns < to_ns:
        until, u, known = _interval(k, to_ns, stamps, samples, end)
        dt = (until - from_ns) * 1e-9
        if not known:
            x, P = coast(x, P, dt, blind, bounds)
        else:
            noisy = model
            if u[6] > 0.0:
                noisy = model.copy()
                noisy[2] += u[6]
            x, P = advance(x, P, u[:6], dt, noisy, bounds)
        from_ns, k = until, k + 1
    return x, P


@njit(cache=True, error_model="numpy")
def predict_each(
    x: Float64s,
    P: Float64s,
    from_ns: int,
    to_ns: int,
    stamps: Int64s,
    samples: Float64s,
    begin: int,
    end: int,
    model: Float64s,
    blind: Float64s,
    bounds: Float64s,
) -> tuple[Float64s, Float64s, Int64s]:
    """`predict` to every sample on the way: states (n, 19), covariances (n, 15, 15) and stamps (n,)."""
    first = begin + int(np.searchsorted(stamps[begin:end], from_ns, side="right"))
    last = begin + int(np.searchsorted(stamps[begin:end], to_ns, side="right"))
    xs, Ps = np.empty((last - first, STATES)), np.empty((last - first, ERRORS, ERRORS))
    for k in range(first, last):
        x, P = predict(x, P, from_ns, stamps[k], stamps, samples, begin, end, model, blind, bounds)
        xs[k - first], Ps[k - first] = x, P
        from_ns = stamps[k]
    return xs, Ps, stamps[first:last]


@njit(cache=True, error_model="numpy")
def predict_states(
    xs: Float64s,
    known: Int64s,
    times: Int64s,
    stamps: Int64s,
    samples: Float64s,
    begin: int,
    end: int,
    model: Float64s,
) -> Float64s:
    """States (k, 19) at `times`, each carried on without its covariance from the last of xs (n, 19) before."""
    out = np.empty((len(times), STATES))
    for i in range(len(times)):
        start = max(int(np.searchsorted(known, times[i], side="right")) - 1, 0)
        state = _carry(xs[start], known[start], times[i], stamps, samples, begin, end, model)
        for j in range(STATES):
            out[i, j] = state[j]
    return out


@njit(cache=True, error_model="numpy")
def _carry(
    x: Float64s, from_ns: int, to_ns: int, stamps: Int64s, samples: Float64s, begin: int, end: int, model: Float64s
) -> Float64s:
    """The x of `predict`, but for what the bounds of P do to it."""
    k = begin + int(np.searchsorted(stamps[begin:end], from_ns, side="right"))
    while from_ns < to_ns:
        until, u, sure = _interval(k, to_ns, stamps, samples, end)
        dt = (until - from_ns) * 1e-9
        if sure:
            x = move(x, u[:6], dt, model[0], model[1])
        else:
            x = move(x, _straight(x, model[0]), min(dt, BLIND_SPAN), model[0], model[1])
        from_ns, k = until, k + 1
    return x


@njit(cache=True, error_model="numpy")
def _interval(k: int, to_ns: int, stamps: Int64s, samples: Float64s, end: int) -> tuple[int, Float64s, bool]:
    """Up to when sample k, or what held before it, is the input; that input; and whether it is known at all."""
    if k < end:
        return min(stamps[k], to_ns), 0.5 * (samples[k - 1] + samples[k]), stamps[k] - stamps[k - 1] <= MAX_GAP_NS
    return to_ns, samples[end - 1].copy(), to_ns - stamps[end - 1] <= MAX_GAP_NS


@njit(cache=True, error_model="numpy")
def coast(x: Float64s, P: Float64s, dt: float, blind: Float64s, bounds: Float64s) -> tuple[Float64s, Float64s]:
    """The belief after `dt` seconds without input: straight on, in small steps, with the noise of the unknown."""
    dt = min(dt, BLIND_SPAN)
    steps = max(1, math.ceil(dt / BLIND_STEP))
    for _ in range(steps):
        x, P = advance(x, P, _straight(x, blind[0]), dt / steps, blind, bounds)
    return x, P


@njit(cache=True, error_model="numpy")
def _straight(x: Float64s, gravity: float) -> Float64s:
    """The input of a base that neither turns nor accelerates."""
    R = _matrix(x[:4])
    u = x[10:16].copy()
    for i in range(3):
        u[3 + i] += gravity * R[2, i]
    return u
