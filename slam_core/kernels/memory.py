"""How kernels reach memory: as LLVM makes vectors of it, or checked where NUMBA_BOUNDSCHECK=1 asks numba to check.

Which of the two is settled when this is imported.
"""

from typing import Any

from numba import config

from slam_core.kernels import checked, intrinsics

CHECKED = bool(getattr(config, "BOUNDSCHECK", None))  # numba sets it from the environment

_access: Any = checked if CHECKED else intrinsics
alias_scope, pair, occupied, prefetch = _access.alias_scope, _access.pair, _access.occupied, _access.prefetch
lowest = intrinsics.lowest  # reads no memory
