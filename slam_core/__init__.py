"""Hector SLAM, section by section: numpy, numba and the standard library only; no files, threads, clocks."""
