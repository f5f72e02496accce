"""What kernels tell the compiler of the memory that they read and write."""

import re

import numpy as np
from numba import njit

from slam_core.kernels.intrinsics import alias_scope

get, _ = alias_scope(0)
_, put = alias_scope(1)
DOMAIN = re.compile(r'!\{!"scope [0-9]", (![0-9]+)\}')


@njit
def copy(source, target):
    """Every number of one array into another that is as long."""
    for k in range(len(source)):
        put(target, k, get(source, k))


@njit
def copy_back(source, target):
    """The same, the other way round."""
    for k in range(len(source)):
        put(source, k, get(target, k))


@njit
def there_and_back(source, target):
    """What the first puts, the second gets."""
    copy(source, target)
    copy_back(source, target)


def test_alias_scopes_hold_within_one_function() -> None:
    """One kernel gets what another has put, in one piece of code: neither's word binds the other."""
    source, target = np.arange(9.0), np.zeros(9)
    there_and_back(source, target)
    assert (target == source).all()
    (code,) = there_and_back.inspect_llvm().values()
    assert len(set(DOMAIN.findall(code))) == 2
