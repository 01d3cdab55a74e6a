"""A product and a sum rounded once: one instruction in place of two, and the same in a single run and in every lane."""

import platform
from typing import Any

from llvmlite.binding import get_host_cpu_features
from numba.core import types
from numba.core.extending import intrinsic

IS_ONE_INSTRUCTION = platform.machine().lower() in ("arm64", "aarch64") or get_host_cpu_features().get("fma", False)
"""Where it is none it would be a slow call, so that product and sum are then rounded each."""


@intrinsic
def fused(typing: Any, factor: Any, other: Any, summand: Any) -> Any:
    """Return `factor` `other` + `summand`."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        if IS_ONE_INSTRUCTION:
            return builder.fma(*arguments)
        return builder.fadd(builder.fmul(*arguments[:2]), arguments[2])

    return types.float64(types.float64, types.float64, types.float64), generate


fused._set_uuid(f"{__name__}.fused")  # see compiled.named
