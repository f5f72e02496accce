"""IMU propagation through recorded samples in one call; state, covariance and model as in `.navigation`.

Recorded are stamps (n,) in nanoseconds and samples (n, 7), input u and a squared noise density that is added to
the gyros', which count from `begin` to `end`; the first is not later than the given estimate. Between two samples
their mean holds, after the last it alone, over a gap nothing. The system is the model, the one that holds over a
gap, and the bounds.
"""

import math

import numpy as np
from numba import njit

from slam_core.kernels.linear import fill_estimate
from slam_core.kernels.navigation import STATES, advance, move, workspace
from slam_core.kernels.rotations import cosines
from slam_core.measurements import Float64s, Int64s

# Between two inertial samples further apart than this, or this long after the last, the motion is unknown.
MAX_GAP_NS = 200_000_000
COLUMNS = 7  # of a sample
UNAIDED_STEP = 0.05  # s
UNAIDED_SPAN = 10.0  # s, after which nothing more can be forgotten

Rows = tuple[Float64s, Float64s, Int64s]
Recorded = tuple[Int64s, Float64s, int, int]
System = tuple[Float64s, Float64s, Float64s]
Output = tuple[Float64s, Float64s, Float64s]


@njit(cache=True, error_model="numpy")
def predict(
    x: Float64s, P: Float64s, from_ns: int, to_ns: int, recorded: Recorded, system: System
) -> tuple[Float64s, Float64s]:
    """The estimate of one time at a later one, in new arrays."""
    x, P = x.copy(), P.copy()
    _propagate(x, P, from_ns, to_ns, recorded, system, workspace())
    return x, P


@njit(cache=True, error_model="numpy")
def _propagate(
    x: Float64s, P: Float64s, from_ns: int, to_ns: int, recorded: Recorded, system: System, work: Float64s
) -> None:
    """`predict` in place."""
    if from_ns >= to_ns:
        return
    model, unaided, bounds = system
    k, u = _later(recorded, from_ns), np.empty(COLUMNS)
    while from_ns < to_ns:
        until, known = _interval(k, to_ns, recorded, u)
        dt = (until - from_ns) * 1e-9
        if not known:
            _coast(x, P, dt, unaided, bounds, work)
        else:
            noisy = model
            if u[6] > 0.0:
                noisy = model.copy()
                noisy[2] += u[6]
            advance(x, P, u, dt, noisy, bounds, work)
        from_ns, k = until, k + 1


@njit(cache=True, error_model="numpy")
def propagate(
    rows: Rows,
    count: int,
    from_ns: int,
    since_ns: Int64s,
    to_ns: int,
    recorded: Recorded,
    system: System,
    output: Output,
) -> int:
    """The estimate at `to_ns`, and the states alone at the times from_ns + since_ns (k,).

    rows: xs (n, 19), Ps (n, 15, 15), stamps (n,): a given estimate, and those at the samples after it, of which
    `count` are known. Returns how many are known then. They are computed up to the last of all times, or until all
    rows are full: then the output is not valid. output: takes the states (k, 19), and x and P.
    """
    (xs, Ps, known), (states, x, P), model = rows, output, system[0]
    last_ns = to_ns
    for i in range(len(since_ns)):
        last_ns = max(last_ns, from_ns + since_ns[i])
    work = workspace()
    count = _extend(rows, count, last_ns, recorded, system, work)
    for i in range(len(since_ns)):
        time_ns = from_ns + since_ns[i]
        k = _last(known, count, time_ns)
        state = _carry(xs[k], known[k], time_ns, recorded, model)
        for j in range(STATES):
            states[i, j] = state[j]
    k = _last(known, count, to_ns)
    fill_estimate(x, P, xs[k], Ps[k])
    _propagate(x, P, known[k], to_ns, recorded, system, work)
    return count


@njit(cache=True, error_model="numpy")
def _extend(rows: Rows, count: int, to_ns: int, recorded: Recorded, system: System, work: Float64s) -> int:
    """`predict` from sample to sample up to an instant, while there are rows; how many are known then."""
    (xs, Ps, known), n = rows, count
    if known[n - 1] < to_ns:
        stamps, _, _, end = recorded
        first = _later(recorded, known[n - 1])
        for k in range(first, min(end, first + len(xs) - n)):
            if stamps[k] > to_ns:
                break
            x, P, known[n] = xs[n], Ps[n], stamps[k]
            fill_estimate(x, P, xs[n - 1], Ps[n - 1])
            _propagate(x, P, known[n - 1], known[n], recorded, system, work)
            n += 1
    return n


@njit(cache=True, error_model="numpy")
def _later(recorded: Recorded, time_ns: int) -> int:
    """The first sample after an instant."""
    stamps, _, begin, end = recorded
    return begin + int(np.searchsorted(stamps[begin:end], time_ns, side="right"))


@njit(cache=True, error_model="numpy")
def _last(known: Int64s, count: int, time_ns: int) -> int:
    """The last row that is not later than an instant, or the first of all."""
    k = count - 1
    while k > 0 and known[k] > time_ns:
        k -= 1
    return k


@njit(cache=True, error_model="numpy")
def _carry(x: Float64s, from_ns: int, to_ns: int, recorded: Recorded, model: Float64s) -> Float64s:
    """The x of `predict`, but for what the bounds of P do to it."""
    k, u = _later(recorded, from_ns), np.empty(COLUMNS)
    while from_ns < to_ns:
        until, sure = _interval(k, to_ns, recorded, u)
        dt = (until - from_ns) * 1e-9
        if sure:
            x = move(x, u, dt, model[0], model[1])
        else:
            x = move(x, _straight(x, model[0]), min(dt, UNAIDED_SPAN), model[0], model[1])
        from_ns, k = until, k + 1
    return x


@njit(cache=True, error_model="numpy")
def _interval(k: int, to_ns: int, recorded: Recorded, u: Float64s) -> tuple[int, bool]:
    """Up to when sample k, or what held before it, is the input u (7,), and whether that is known."""
    stamps, samples, _, end = recorded
    next_k = min(k, end - 1)
    for i in range(COLUMNS):
        u[i] = 0.5 * (samples[k - 1, i] + samples[next_k, i])
    if k < end:
        return min(stamps[k], to_ns), stamps[k] - stamps[k - 1] <= MAX_GAP_NS
    return to_ns, to_ns - stamps[k - 1] <= MAX_GAP_NS


@njit(cache=True, error_model="numpy")
def coast(x: Float64s, P: Float64s, dt: float, unaided: Float64s, bounds: Float64s) -> tuple[Float64s, Float64s]:
    """The estimate after `dt` seconds without input: constant velocity in small steps, with its noise."""
    x, P = x.copy(), P.copy()
    _coast(x, P, dt, unaided, bounds, workspace())
    return x, P


@njit(cache=True, error_model="numpy")
def _coast(x: Float64s, P: Float64s, dt: float, unaided: Float64s, bounds: Float64s, work: Float64s) -> None:
    """`coast` in place."""
    dt = min(dt, UNAIDED_SPAN)
    steps = max(1, math.ceil(dt / UNAIDED_STEP))
    for _ in range(steps):
        advance(x, P, _straight(x, unaided[0]), dt / steps, unaided, bounds, work)


@njit(cache=True, error_model="numpy")
def _straight(x: Float64s, gravity: float) -> Float64s:
    """The input of a base that neither turns nor accelerates."""
    R, u = cosines(x), x[10:16].copy()
    for i in range(3):
        u[3 + i] += gravity * R[6 + i]
    return u
