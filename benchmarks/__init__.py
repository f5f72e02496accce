"""Measurements and pictures: `python -m benchmarks.NAME`. Compiled kernels are kept as the program keeps them."""

from hectorscope.common.kernel_cache import keep_compiled, user_cache

keep_compiled(user_cache())
