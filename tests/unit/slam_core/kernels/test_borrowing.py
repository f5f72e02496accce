"""How compiled code takes arrays from Python."""

import gc
import sys

import numpy as np
from numba import njit
from numba.core.runtime import _nrt_python, rtsys

from slam_core.kernels.planar import inverse3, sigmas_apart


@njit
def larger(a, b):
    """Whichever of two arrays (n,) begins with the larger number."""
    return a if a[0] > b[0] else b


def test_arrays_that_are_handed_over_are_not_counted() -> None:
    """A call makes no object for its arguments; what a kernel makes itself it takes away again."""
    pose, covariance = np.ones(3), np.eye(3)
    sigmas_apart(pose, covariance, pose, covariance)  # compiled
    _nrt_python.memsys_enable_stats()
    try:
        before = rtsys.get_allocation_stats()
        found = inverse3(covariance)
        after = rtsys.get_allocation_stats()
        assert after.mi_alloc - before.mi_alloc == 1  # the result
        assert after.mi_free == before.mi_free
        assert (found == covariance).all()
        del found
        sigmas_apart(pose, covariance, pose, covariance)
        gone = rtsys.get_allocation_stats()
        assert gone.mi_alloc - gone.mi_free == before.mi_alloc - before.mi_free
    finally:
        _nrt_python.memsys_disable_stats()


def test_an_array_that_comes_back_is_the_same() -> None:
    """Returned as a whole it is the caller's own, with its own references, not another one on its memory."""
    a, b = np.array([1.0, 2.0]), np.array([3.0, 4.0])
    assert larger(a, b) is b
    held = sys.getrefcount(a), sys.getrefcount(b)
    for _ in range(100):
        larger(a, b)
    assert (sys.getrefcount(a), sys.getrefcount(b)) == held


def test_what_a_kernel_makes_outlives_the_call() -> None:
    """And what it was made of."""
    made = [inverse3(np.diag([1.0, 2.0, float(k)])) for k in range(1, 200)]
    gc.collect()
    for k, inverse in enumerate(made, start=1):
        np.testing.assert_allclose(inverse, np.diag([1.0, 0.5, 1.0 / k]))
