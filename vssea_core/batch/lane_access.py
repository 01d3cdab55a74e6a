"""Reading and writing one lane of an array in which every number of LANES runs stands side by side.

The array is one block of memory, number `k` of lane `j` at k LANES + j. With constant offsets and a single base the compiler
sees that lanes do not meet, and turns the loop over them into vector instructions.
"""

from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import types
from numba.core.extending import intrinsic
from numba.np.arrayobj import make_array
from numpy.typing import NDArray

LANES = 16
"""Runs side by side: two vectors of eight doubles, which hides the time an instruction takes behind the other one."""
CACHE_LINE = 64
"""Bytes; a vector of eight doubles."""


@intrinsic
def lane(typing: Any, array: Any, at: Any, count: Any) -> Any:
    """Return `count` (a constant) numbers of a lane as a tuple, the first at index `at`."""
    if not isinstance(count, types.IntegerLiteral):
        return None
    numbers = types.UniTuple(array.dtype, count.literal_value)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        data = make_array(signature.args[0])(context, builder, arguments[0]).data
        values = [builder.load(_place(builder, data, arguments[1], k)) for k in range(numbers.count)]
        return context.make_tuple(builder, numbers, values)

    return numbers(array, types.intp, count), generate


@intrinsic
def put_lane(typing: Any, array: Any, at: Any, values: Any) -> Any:
    """Write a tuple of numbers into a lane, the first at index `at`."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        data = make_array(signature.args[0])(context, builder, arguments[0]).data
        for k in range(len(values)):
            builder.store(builder.extract_value(arguments[2], k), _place(builder, data, arguments[1], k))
        return context.get_dummy_value()

    return types.void(array, types.intp, values), generate


@intrinsic
def align_stack(typing: Any) -> Any:
    """Have the function around it keep its stack at multiples of a cache line: what it spills are whole vectors."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        builder.function.attributes.add("nounwind")  # alone, the other would not be written down
        builder.function.attributes.alignstack = CACHE_LINE
        return context.get_dummy_value()

    return types.void(), generate


def aligned_lanes(numbers: int) -> NDArray[np.float64]:
    """Return zeros (numbers, LANES) that begin with a cache line, so that each vector of them lies in one."""
    block = np.zeros(numbers * LANES + CACHE_LINE // 8)
    first = -block.ctypes.data % CACHE_LINE // 8
    return block[first : first + numbers * LANES].reshape(numbers, LANES)


def _place(builder: Any, data: Any, at: Any, k: int) -> Any:
    return builder.gep(data, [builder.add(at, ir.Constant(at.type, k * LANES))], inbounds=True)


for _intrinsic in (lane, put_lane, align_stack):
    _intrinsic._set_uuid(f"{__name__}.{_intrinsic._name}")  # see compiled.named
