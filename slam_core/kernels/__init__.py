"""The numba code behind the other packages."""

from typing import Any

# Options of njit for a function that compiled code alone calls: what Python would call it by, and a place in the
# cache beside that of its callers, take time to compile and to keep.
INNER: dict[str, Any] = {"error_model": "numpy", "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
