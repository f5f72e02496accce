"""LLVM intrinsics for vectorised memory access, which numba does not offer.

Arrays that a kernel reads and writes never overlap, but only its caller knows that. Accesses of different
alias scopes declare it by the aliasing metadata of LLVM. Without it, a loop that gathers or that stores into
several arrays stays scalar, four to six times as slow. That holds within a function: what one has put, another
may get. Arrays are flat and contiguous, and indices count from 0.
"""

from typing import Any

from llvmlite import ir  # of numba
from numba import extending, types

SCOPES = range(3)

intrinsic: Any = extending.intrinsic  # its own types leave out that calls lack the first argument


def alias_scope(own: int) -> tuple[Any, Any]:
    """get(array, i) and put(array, i, value) for arrays that share no memory with those of other alias scopes."""

    @intrinsic
    def get(_: Any, array: Any, i: Any) -> Any:
        def load(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            return _apart(builder, builder.load(_address(context, builder, signature, arguments)), own)

        return array.dtype(array, i), load

    @intrinsic
    def put(_: Any, array: Any, i: Any, value: Any) -> Any:
        def store(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            _apart(builder, builder.store(arguments[2], _address(context, builder, signature, arguments)), own)
            return context.get_dummy_value()

        return types.void(array, i, array.dtype), store

    return get, put


@intrinsic
def pair(_: Any, cells: Any, i: Any) -> Any:
    """cells[i] and, in the high half, cells[i + 1] of an array in scope 0: two of int16 or of uint32 as one."""
    both: Any = types.uint32 if cells.dtype == types.int16 else types.uint64

    def load(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        word = context.get_value_type(both).as_pointer()
        loaded = builder.load(builder.bitcast(_address(context, builder, signature, arguments), word))
        loaded.align = cells.dtype.bitwidth // 8
        return _apart(builder, loaded, 0)

    return both(cells, i), load


@intrinsic
def occupied(_: Any, cells: Any, i: Any) -> Any:
    """Which of cells[i : i + 32] of an array of int16 in scope 0 are above 0: the bits of a uint32."""

    def compare(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        vector = ir.VectorType(context.get_value_type(types.int16), 32)
        place = _address(context, builder, signature, arguments)
        loaded = builder.load(builder.bitcast(place, vector.as_pointer()))
        loaded.align = 2
        return builder.bitcast(builder.icmp_signed(">", _apart(builder, loaded, 0), vector(None)), ir.IntType(32))

    return types.uint32(cells, i), compare


@intrinsic
def lowest(_: Any, bits: Any) -> Any:
    """The place of the lowest bit of a uint32 that is set."""

    def count(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.cttz(arguments[0], ir.IntType(1)(1))

    return types.uint32(bits), count


@intrinsic
def prefetch(_: Any, array: Any, i: Any) -> Any:
    """Have the cache line of array[i] fetched, which will be written."""

    def fetch(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        place = builder.bitcast(_address(context, builder, signature, arguments), ir.IntType(8).as_pointer())
        number = ir.IntType(32)
        kind = ir.FunctionType(ir.VoidType(), [place.type, number, number, number])
        function = builder.module.declare_intrinsic("llvm.prefetch", [place.type], kind)
        builder.call(function, [place, number(1), number(3), number(1)])  # to write, to keep, data
        return context.get_dummy_value()

    return types.void(array, i), fetch


def _address(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    array = context.make_array(signature.args[0])(context, builder, arguments[0])
    place = context.cast(builder, arguments[1], signature.args[1], types.int64)
    return builder.gep(array.data, [place], inbounds=True)


def _apart(builder: Any, access: Any, own: int) -> Any:
    """The access, marked as one of its alias scope and of no other."""
    add = builder.module.add_metadata
    domain = add([builder.function.name])
    scopes = [add([f"scope {k}", domain]) for k in SCOPES]
    access.set_metadata("alias.scope", add([scopes[own]]))
    access.set_metadata("noalias", add([scope for k, scope in enumerate(scopes) if k != own]))
    return access
