"""Arrays that Python hands to compiled code are borrowed, for as long as the call lasts.

By itself numba counts a reference to each: an object for that comes and goes with every argument, and wherever the
array is passed on its count goes up and down, locked. A step hands over some hundred arrays. The caller holds them
anyway, so there is nothing to count; for targets without counts numba takes arrays in the same way.

What a kernel returns must be an array of its own, or one that it was given as a whole: a part of one that it was
given would outlive what it is a part of. This holds for all that numba compiles in the process.
"""

from typing import Any

from llvmlite import ir  # of numba
from numba import types
from numba.core import boxing, cgutils  # noqa: F401  # boxing would come later by itself, with its own way
from numba.core.pythonapi import _unboxers
from numba.extending import NativeValue

ADAPT = "numba_adapt_ndarray"  # numba's own: fills an array structure that counts nothing


def _borrow(kind: Any, array: Any, c: Any) -> Any:
    """The code that takes an array of a kind from Python."""
    taken = c.context.make_array(kind)(c.context, c.builder)
    place = taken._getpointer()
    signature = ir.FunctionType(ir.IntType(32), [c.pyapi.pyobj, c.pyapi.voidptr])
    adapt = cgutils.get_or_insert_function(c.builder.module, signature, ADAPT)
    failed = c.builder.call(adapt, [array, c.builder.bitcast(place, c.pyapi.voidptr)])
    is_error = cgutils.is_not_null(c.builder, failed)
    with c.builder.if_then(is_error, likely=False):
        c.pyapi.err_set_string("PyExc_TypeError", "a kernel was given something else in the place of an array")
    return NativeValue(c.builder.load(place), is_error=is_error)


_unboxers.functions[types.Array] = _borrow
