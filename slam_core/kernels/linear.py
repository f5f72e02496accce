"""Covariances in closed form: numba's own `@` and np.linalg would need scipy."""

import math

import numpy as np
from numba import njit

from slam_core.measurements import Float64s


@njit(cache=True, error_model="numpy")
def multiply(A: Float64s, B: Float64s) -> Float64s:
    """A B, skipping the zeros of A: transition and observer matrices are mostly empty."""
    out = np.zeros((A.shape[0], B.shape[1]))
    for i in range(A.shape[0]):
        for k in range(A.shape[1]):
            a = A[i, k]
            if a != 0.0:
                for j in range(B.shape[1]):
                    out[i, j] += a * B[k, j]
    return out


@njit(cache=True, error_model="numpy")
def fill(out: Float64s, A: Float64s) -> None:
    """The values of A into an array of its shape: to assign a slice takes numba seconds to compile."""
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            out[i, j] = A[i, j]


@njit(inline="always")
def assign(out: Float64s, a: Float64s) -> None:
    """`fill` of vectors."""
    for i in range(len(a)):
        out[i] = a[i]


@njit(cache=True, error_model="numpy")
def add(A: Float64s, B: Float64s, weight: float) -> Float64s:
    """A + weight B in the place of A; numba's own arithmetic on arrays makes new ones, and much code for that."""
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            A[i, j] += weight * B[i, j]
    return A


@njit(cache=True, error_model="numpy")
def fill_estimate(x: Float64s, P: Float64s, new_x: Float64s, new_P: Float64s) -> None:
    """The values of a state (n,) and its covariance (m, m) into arrays of their shapes."""
    for i in range(len(x)):
        x[i] = new_x[i]
    fill(P, new_P)


@njit(cache=True, error_model="numpy")
def sandwich(A: Float64s, P: Float64s) -> Float64s:
    """A P A^T of a symmetric P, symmetric to the last bit."""
    return symmetric(multiply(A, multiply(A, P).T))


@njit(cache=True, error_model="numpy")
def symmetric(P: Float64s) -> Float64s:
    """P, in place, without what rounding has made of its symmetry."""
    for i in range(len(P)):
        for j in range(i):
            P[i, j] = P[j, i] = 0.5 * (P[i, j] + P[j, i])
    return P


@njit(cache=True, error_model="numpy")
def cholesky(A: Float64s) -> Float64s:
    """Lower L with L L^T = A; the diagonal of L holds NaN or 0 where A is not positive definite."""
    n = len(A)
    L = np.zeros((n, n))
    for i in range(n):
        for j in range(i + 1):
            rest = A[i, j]
            for k in range(j):
                rest -= L[i, k] * L[j, k]
            L[i, j] = math.sqrt(rest) if i == j else rest / L[j, j]
    return L


@njit(cache=True, error_model="numpy")
def solve_lower(L: Float64s, B: Float64s) -> Float64s:
    """L^-1 B for a lower triangle L."""
    out = B.copy()
    for i in range(len(L)):
        for k in range(i):
            for j in range(B.shape[1]):
                out[i, j] -= L[i, k] * out[k, j]
        for j in range(B.shape[1]):
            out[i, j] /= L[i, i]
    return out


@njit(cache=True, error_model="numpy")
def squared_length(S: Float64s, v: Float64s) -> float:
    """v^T S^-1 v; NaN if S is no covariance."""
    whitened = solve_lower(cholesky(S), v.reshape(-1, 1))
    total = 0.0
    for i in range(len(v)):
        total += whitened[i, 0] * whitened[i, 0]
    return total


@njit(cache=True, error_model="numpy")
def gain(P: Float64s, CP: Float64s, S: Float64s, innovation: Float64s) -> tuple[Float64s, Float64s]:
    """K innovation and P - K C P with K = P C^T S^-1.

    Through W = L^-1 C P with L L^T = S, since K C P = W^T W: symmetric by its making.
    """
    L = cholesky(S)
    W = solve_lower(L, CP)
    whitened = solve_lower(L, innovation.reshape(-1, 1))
    correction = np.zeros(len(P))
    reduced = P.copy()
    for k in range(len(CP)):
        for i in range(len(P)):
            w = W[k, i]
            correction[i] += w * whitened[k, 0]
            for j in range(len(P)):
                reduced[i, j] -= w * W[k, j]
    return correction, reduced


@njit(cache=True, error_model="numpy")
def is_covariance(A: Float64s) -> bool:
    """Whether A is finite, symmetric (to 1e-6 of its size) and positive definite."""
    for i in range(len(A)):
        for j in range(i):
            if not abs(A[i, j] - A[j, i]) <= 1e-6 * math.sqrt(abs(A[i, i] * A[j, j])):
                return False
    L, definite = cholesky(A), True
    for i in range(len(A)):
        definite &= 0.0 < L[i, i] < np.inf
    return definite


@njit(cache=True, error_model="numpy")
def is_measurement(values: Float64s, R: Float64s, limit: float) -> bool:
    """Whether every |value| is below a limit and R is a covariance."""
    for i in range(len(values)):
        if not abs(values[i]) < limit:
            return False
    return is_covariance(R)


@njit(cache=True, error_model="numpy")
def is_sound(x: Float64s, P: Float64s) -> bool:
    """Whether x and P are finite and no variance is zero or negative."""
    for i in range(len(x)):
        if not math.isfinite(x[i]):
            return False
    for i in range(len(P)):
        if not P[i, i] > 0.0:
            return False
        for j in range(len(P)):
            if not math.isfinite(P[i, j]):
                return False
    return True
