"""Measurements and pictures: `python -m benchmarks.NAME`. Compiled kernels are kept as the program keeps them."""

from hectorscope.common.kernel_cache import cache_places, keep_compiled

keep_compiled(*cache_places())
