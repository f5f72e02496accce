"""IMU propagation through recorded samples in one call; state, covariance and model as in `.navigation`.

Recorded are stamps (n,) in nanoseconds and samples (n, 8), input u with squared noise densities that are added to
those of gyros and accelerometers, which count from `begin` to `end`; the first is not later than the given
estimate. Between two samples their mean holds, after the last it alone, over a gap nothing. The system is the
model, the one that holds over a gap, and the bounds.
"""

import math

import numpy as np
from numba import njit

from slam_core.kernels import INNER
from slam_core.kernels.linear import fill_estimate
from slam_core.kernels.navigation import STATES, advance, move, workspace
from slam_core.kernels.rotations import cosines
from slam_core.measurements import Float64s, Int64s

# Between two inertial samples further apart than this, or this long after the last, the motion is unknown.
MAX_GAP_NS = 200_000_000
COLUMNS = 8  # of a sample
UNAIDED_STEP = 0.05  # s
UNAIDED_SPAN = 10.0  # s, after which nothing more can be forgotten

Rows = tuple[Float64s, Float64s, Int64s]
Recorded = tuple[Int64s, Float64s, int, int]
System = tuple[Float64s, Float64s, Float64s]
Output = tuple[Float64s, Float64s, Float64s]


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
    (xs, Ps, known), (states, last_x, last_P), (stamps, _, _, end) = rows, output, recorded
    last_ns = to_ns
    for i in range(len(since_ns)):
        last_ns = max(last_ns, from_ns + since_ns[i])
    work, u = workspace(), np.empty(COLUMNS)
    k = _later(recorded, known[count - 1])
    # The rows after the given one, then the estimate itself: one loop, as its body is much code to compile.
    extends = True
    while extends:
        extends = count < len(xs) and k < end and known[count - 1] < last_ns and stamps[k] <= last_ns
        before = count - 1 if extends else _last(known, count, to_ns)
        x, P = (xs[count], Ps[count]) if extends else (last_x, last_P)
        fill_estimate(x, P, xs[before], Ps[before])
        _propagate(x, P, known[before], stamps[k] if extends else to_ns, recorded, system, work, u)
        if extends:
            known[count] = stamps[k]
            count, k = count + 1, k + 1
    for i in range(len(since_ns)):
        time_ns = from_ns + since_ns[i]
        k = _last(known, count, time_ns)
        _carry(states[i], xs[k], known[k], time_ns, recorded, system[0], u)
    return count


@njit(inline="always")
def _propagate(
    x: Float64s,
    P: Float64s,
    from_ns: int,
    to_ns: int,
    recorded: Recorded,
    system: System,
    work: Float64s,
    u: Float64s,
) -> None:
    """The estimate of one time at a later one, in place.

    Without input the velocity is constant: small steps, with the noise of that.
    """
    model, unaided, bounds = system
    k = _later(recorded, from_ns)
    while from_ns < to_ns:
        until, known = _interval(k, to_ns, recorded, u)
        dt = (until - from_ns) * 1e-9
        noisy, steps = unaided, 1
        if not known:
            dt = min(dt, UNAIDED_SPAN)
            steps = max(1, math.ceil(dt / UNAIDED_STEP))
        else:
            noisy = model
            if u[6] > 0.0:
                noisy = model.copy()
                noisy[2] += u[6]
                noisy[3] += u[7]
                if u[7] > 0.0:
                    noisy[1] = math.inf  # the force of a base that is shaken does not show where down is
        for _ in range(steps):
            if not known:
                _straight(x, unaided[0], u)
            advance(x, P, u, dt / steps, noisy, bounds, work)
        from_ns, k = until, k + 1


@njit(**INNER)
def _later(recorded: Recorded, time_ns: int) -> int:
    """The first sample after an instant."""
    stamps, _, low, high = recorded
    while low < high:  # numpy's search takes long to compile
        middle = (low + high) // 2
        if stamps[middle] > time_ns:
            high = middle
        else:
            low = middle + 1
    return low


@njit(inline="always")
def _last(known: Int64s, count: int, time_ns: int) -> int:
    """The last row that is not later than an instant, or the first of all."""
    k = count - 1
    while k > 0 and known[k] > time_ns:
        k -= 1
    return k


@njit(inline="always")
def _carry(
    out: Float64s, x: Float64s, from_ns: int, to_ns: int, recorded: Recorded, model: Float64s, u: Float64s
) -> None:
    """The x that `_propagate` makes of x, but for what the bounds of P do to it, into `out` (19,)."""
    for j in range(STATES):
        out[j] = x[j]
    k = _later(recorded, from_ns)
    while from_ns < to_ns:
        until, sure = _interval(k, to_ns, recorded, u)
        dt = (until - from_ns) * 1e-9
        if not sure:
            _straight(out, model[0], u)
            dt = min(dt, UNAIDED_SPAN)
        moved = move(out, u, dt, model[0], model[1])
        for j in range(STATES):
            out[j] = moved[j]
        from_ns, k = until, k + 1


@njit(**INNER)
def _interval(k: int, to_ns: int, recorded: Recorded, u: Float64s) -> tuple[int, bool]:
    """Up to when sample k, or what held before it, is the input u (8,), and whether that is known."""
    stamps, samples, _, end = recorded
    next_k = min(k, end - 1)
    for i in range(COLUMNS):
        u[i] = 0.5 * (samples[k - 1, i] + samples[next_k, i])
    if k < end:
        return min(stamps[k], to_ns), stamps[k] - stamps[k - 1] <= MAX_GAP_NS
    return to_ns, to_ns - stamps[k - 1] <= MAX_GAP_NS


@njit(inline="always")
def _straight(x: Float64s, gravity: float, u: Float64s) -> None:
    """The input of a base that neither turns nor accelerates, into u."""
    R = cosines(x)
    for i in range(6):
        u[i] = x[10 + i]
    for i in range(3):
        u[3 + i] += gravity * R[6 + i]
