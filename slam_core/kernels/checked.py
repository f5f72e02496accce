"""The names of `intrinsics` as plain indexing that raises IndexError outside of an array.

For the checked build (docs/memory-safety.md): numba checks what kernels index themselves, this what they leave to
pointers. An index below 0 is outside, too.
"""

from typing import Any

import numpy as np
from numba import extending, njit, types


@njit
def get(array, i):
    """array[i]."""
    _check(array, i, 1)
    return array[i]


@njit
def put(array, i, value):
    """array[i] = value."""
    _check(array, i, 1)
    array[i] = value


def alias_scope(_: int) -> tuple[Any, Any]:
    """The get and put of every scope; nothing is declared to the compiler."""
    return get, put


def pair(cells: Any, i: Any) -> Any:
    """As `intrinsics.pair`; for compiled code only."""
    raise NotImplementedError


@extending.overload(pair)
def _pair(cells: Any, i: Any) -> Any:
    half, bits, word = (np.uint16, 16, np.uint32) if cells.dtype == types.int16 else (np.uint32, 32, np.uint64)

    def read(cells: Any, i: Any) -> Any:
        _check(cells, i, 2)
        return word(word(half(cells[i])) | word(word(half(cells[i + 1])) << word(bits)))

    return read


@njit
def occupied(cells, i):
    """As `intrinsics.occupied`."""
    _check(cells, i, 32)
    bits = np.uint32(0)
    for k in range(32):
        if cells[i + k] > 0:
            bits |= np.uint32(np.uint32(1) << np.uint32(k))
    return bits


@njit
def prefetch(array, i):
    """Nothing is fetched."""
    _check(array, i, 1)


@njit
def _check(array, i, n):
    """IndexError unless array[i : i + n] exists."""
    if i < 0 or i + n > len(array):
        raise IndexError("index is out of bounds")
