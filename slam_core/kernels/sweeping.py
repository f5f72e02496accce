"""Section IV: every beam of a sweep placed by the motion at its own time."""

from numba import njit


@njit(cache=True, error_model="numpy")
def place_beams(
    ranges,
    cosines,
    sines,
    knots,
    knot_step,
    low,
    high,
    no_return,
    clear_range,
    z_low,
    z_high,
    points,
    zs,
    free,
):
    """Endpoints (n, 2) and heights (n,) in the stabilised frame, and free ends: returns how many of each.

    knots: (k, 3, 4) transforms laser -> stabilised frame every `knot_step` beams. A range in [low, high)
    is an endpoint; one of at least `no_return` clears up to `clear_range`, if that is not 0. z_low <= z <= z_high.
    """
    kept = cleared = 0
    last = len(knots) - 2
    for i in range(len(ranges)):
        r = ranges[i]
        hit = low <= r < high
        if not (hit or (clear_range > 0.0 and r >= no_return)):
            continue
        along = i / knot_step
        k = min(int(along), last)
        f = along - k
        reach = r if hit else clear_range
        lx, ly = reach * cosines[i], reach * sines[i]
        a, b = knots[k], knots[k + 1]
        x = _row(a, b, 0, f, lx, ly)
        y = _row(a, b, 1, f, lx, ly)
        z = _row(a, b, 2, f, lx, ly)
        if z < z_low or z > z_high:
            continue
        if hit:
            points[kept, 0], points[kept, 1], zs[kept] = x, y, z
            kept += 1
        else:
            free[cleared, 0], free[cleared, 1] = x, y
            cleared += 1
    return kept, cleared


@njit(inline="always")
def _row(a, b, j, f, lx, ly):
    p = a[j, 0] * lx + a[j, 1] * ly + a[j, 3]
    q = b[j, 0] * lx + b[j, 1] * ly + b[j, 3]
    return p + f * (q - p)
