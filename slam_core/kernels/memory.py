"""Accesses to memory that numba has no words for, so that LLVM turns the loops around them into gathers.

What a loop reads and what it writes never overlap here, but only the caller knows that: `get`, `pair` and `put`
say so by LLVM's metadata for aliasing. Without it a loop that gathers and stores stays scalar, four times as slow.
"""

from typing import Any

from numba import extending, types

intrinsic: Any = extending.intrinsic  # its own types leave out that calls lack the first argument


@intrinsic
def get(_: Any, array: Any, i: Any) -> Any:
    """array[i] of a flat contiguous array that nothing is `put` into; i: int32."""

    def load(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return _load(builder, _address(context, builder, signature, arguments))

    return array.dtype(array, i), load


@intrinsic
def pair(_: Any, cells: Any, i: Any) -> Any:
    """cells[i] and, in the high half, cells[i + 1] of such an array of uint16, as a uint32."""

    def load(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        word = context.get_value_type(types.uint32).as_pointer()
        loaded = _load(builder, builder.bitcast(_address(context, builder, signature, arguments), word))
        loaded.align = 2
        return loaded

    return types.uint32(cells, i), load


@intrinsic
def put(_: Any, array: Any, i: Any, value: Any) -> Any:
    """array[i] = value, for a flat contiguous array that is not read; i: int32."""

    def store(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        stored = builder.store(arguments[2], _address(context, builder, signature, arguments))
        stored.set_metadata("noalias", _scope(builder))
        return context.get_dummy_value()

    return types.void(array, i, array.dtype), store


def _address(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    array = context.make_array(signature.args[0])(context, builder, arguments[0])
    place = builder.sext(arguments[1], context.get_value_type(types.int64))
    return builder.gep(array.data, [place], inbounds=True)


def _load(builder: Any, address: Any) -> Any:
    loaded = builder.load(address)
    loaded.set_metadata("alias.scope", _scope(builder))
    return loaded


def _scope(builder: Any) -> Any:
    """The scope of all that is read."""
    domain = builder.module.add_metadata(["slam_core"])
    return builder.module.add_metadata([builder.module.add_metadata(["read", domain])])
