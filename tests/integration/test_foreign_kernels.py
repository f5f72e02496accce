"""Importing and running slam_core changes nothing for the kernels of others in the same process."""

import subprocess
import sys

import pytest

FOREIGN = """
import numpy as np
{imports}
from numba import njit
from numba.experimental import jitclass
from numba import float64


@njit
def tail(a):
    return a[1:]


@njit
def ends(a):
    return a[:1], a[-1:], a


@njit
def column(m, j):
    return m[:, j]


@njit
def grown(values):
    values.append(3.0)
    return values


@jitclass([("held", float64[:])])
class Holder:
    def __init__(self, a):
        self.held = a[1:]


{run}
kept = []
for k in range(2000):
    a = np.arange(1000.0) + k
    kept.append((tail(a), ends(a), column(a.reshape(10, 100), 3), Holder(a)))
    del a
    np.full(1000, np.nan)  # memory that was freed too early would hold this now
for k, (rest, (first, last, whole), third, holder) in enumerate(kept):
    a = np.arange(1000.0) + k
    assert (rest == a[1:]).all() and first[0] == a[0] and last[0] == a[-1] and (whole == a).all()
    assert (third == a.reshape(10, 100)[:, 3]).all() and (holder.held == a[1:]).all()
assert grown([1.0, 2.0]) == [1.0, 2.0, 3.0]
print("unharmed")
"""
RUN = """
slam = hs.HectorSlam()
angles = np.linspace(-np.pi, np.pi, 361)
for k in range(5):
    ranges = 2.02 / np.maximum(np.abs(np.cos(angles)), np.abs(np.sin(angles)))
    slam.add(hs.LaserScan(k * 100_000_000, ranges, angles[0], angles[1] - angles[0]))
assert slam.finish()
"""


@pytest.mark.parametrize(
    ("imports", "run"),
    [
        ("import slam_core.slam, slam_core.navigation.filter", ""),
        ("import slam_core as hs", RUN),
        ("import slam_core as hs, hectorscope.run.pipeline, hectorscope.web.server", RUN),
    ],
)
def test_kernels_of_others_keep_what_they_return(imports: str, run: str):
    """Views, lists and classes that a user's kernels make outlive the arrays that they were made of."""
    code = FOREIGN.format(imports=imports, run=run)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=600, check=False)
    assert (done.returncode, done.stdout.strip()) == (0, "unharmed"), done.stderr
