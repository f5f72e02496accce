"""Section V-B: covariance intersection of a full state with a projection of it from another estimator.

The two errors are correlated in an unknown way: the match starts from the filter, and the map was drawn with it.
So the information of each is weighed, (1 - omega) and omega, before it is added. Printed slips are put right: (17)
has no inverse after its bracket, (18) scales all of P, and (20) holds C P C^T.
"""

import numpy as np

from slam_core.config import FusionMethod
from slam_core.kernels import fusion
from slam_core.measurements import Float64s
from slam_core.results import NOWHERE

RULES: dict[FusionMethod, int] = {
    "fixed": fusion.FIXED,
    "trace": fusion.MIN_TRACE,
    "determinant": fusion.MIN_DETERMINANT,
    "kalman": fusion.KALMAN,
}
NOTHING = np.zeros((0, 0))


def intersect(
    P: Float64s,
    C: Float64s,
    R: Float64s,
    innovation: Float64s,
    omega: float,
    method: FusionMethod = "fixed",
    *,
    unobservable: Float64s = NOWHERE,
    held: Float64s = NOTHING,
) -> tuple[Float64s, Float64s]:
    """Eqs. (18)-(20): the correction K (xi - C x) to add to x, and P+.

    P: (n, n), C: (m, n), R: (m, m), innovation: (m,) xi - C x with angles wrapped, omega in (0, 1).
    K = P C^T ((1 - omega) / omega R + C P C^T)^-1 and P+ = (P - K C P) / (1 - omega). Other methods than "fixed"
    do not ask for omega: they choose it anew, so that P+ has the least trace (relative to P, as the units differ)
    or determinant, or they trust that the errors are independent, which is the Kalman update.

    unobservable: (2,) unit vector in the plane that the match does not observe, or zero; held: (k, n) combinations
    of the state that it leaves alone then, with all that depends on them. C x is (x, y, psi) in that case.
    """
    fused: tuple[Float64s, Float64s] = fusion.fuse_part(
        P, C, R, innovation, RULES[method], omega, unobservable, held, fusion.NONE
    )
    return fused
