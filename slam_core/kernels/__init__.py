"""The numba code behind the modules above it."""

from slam_core.kernels import borrowing as borrowing  # before any of it is compiled
