"""The numba code behind the packages above."""
