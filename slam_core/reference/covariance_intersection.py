"""Section V-B: fusion of the filter with the match by covariance intersection, eqs. (16)-(20)."""

import numpy as np

from slam_core.measurements import Float64s


def intersect_information(
    x: Float64s, P: Float64s, C: Float64s, xi: Float64s, R: Float64s, omega: float
) -> tuple[Float64s, Float64s]:
    """x+ and P+ by eqs. (16)-(17). x: (n,), P: (n, n), C: (m, n), xi: (m,), R: (m, m), omega in (0, 1)."""
    prior, match = (1.0 - omega) * np.linalg.inv(P), omega * C.T @ np.linalg.inv(R)
    fused = np.asarray(np.linalg.inv(prior + match @ C), np.float64)  # (16)
    return fused @ (prior @ x + match @ xi), fused  # (17)


def intersect(
    x: Float64s, P: Float64s, C: Float64s, xi: Float64s, R: Float64s, omega: float
) -> tuple[Float64s, Float64s]:
    """The same by eqs. (18)-(20), which do not invert P."""
    K = P @ C.T @ np.linalg.inv((1.0 - omega) / omega * R + C @ P @ C.T)  # (20)
    return x + K @ (xi - C @ x), (P - K @ C @ P) / (1.0 - omega)  # (19), (18)


def kalman_update(P: Float64s, C: Float64s, R: Float64s, innovation: Float64s) -> tuple[Float64s, Float64s]:
    """The error to add to the state, and P after it, for a measurement with independent noise R."""
    K = P @ C.T @ np.linalg.inv(C @ P @ C.T + R)
    return K @ innovation, P - K @ C @ P
