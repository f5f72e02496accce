"""The numba code behind the modules above it."""
