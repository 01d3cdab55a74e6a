"""How kernels are compiled, and where their machine code is cached.

numba's cache does not see a change in a callee of another file: the cached caller would keep running the old code. The
cache folder is therefore named by a hash of every source file of this package and of the compiler's version.
"""

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba

Kernel = TypeVar("Kernel", bound=Callable[..., Any])


def source_digest(package: Path) -> str:
    """Return a hash over all Python sources below `package` (names and contents) and numba's version."""
    digest = hashlib.sha256(numba.__version__.encode())
    for source in sorted(package.rglob("*.py")):
        digest.update(source.relative_to(package).as_posix().encode() + b"\0" + source.read_bytes())
    return digest.hexdigest()[:16]


def cache_folder() -> Path:
    """Return the folder of this version's machine code: $VSSEA_CACHE_DIR or ~/.cache/vssea, then the source hash."""
    given = os.environ.get("VSSEA_CACHE_DIR")
    base = Path(given) if given else Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache") / "vssea"
    return base.expanduser() / "kernels" / source_digest(Path(__file__).parent)


numba.config.CACHE_DIR = str(cache_folder())


def inlined(function: Kernel) -> Kernel:
    """Compile a part of a kernel: scalars and tuples in and out, always inlined, no fast-math (runs stay equal to the bit)."""
    compiled: Kernel = numba.njit(forceinline=True, error_model="numpy")(function)
    return named(compiled, function)


def written_out(function: Kernel) -> Kernel:
    """Compile a part of a kernel as if it were written where it is called: for the body of a loop over lanes.

    What is merely `inlined` is a small call to the passes that unroll loops, and they come before those that make vectors.
    """
    compiled: Kernel = numba.njit(inline="always", error_model="numpy")(function)
    return named(compiled, function)


def entry(function: Kernel) -> Kernel:
    """Compile a kernel that Python calls: arrays in and out, cached on disk, without the interpreter lock."""
    compiled: Kernel = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    return named(compiled, function)


def called(function: Kernel) -> Kernel:
    """Compile a part of a kernel that few runs need: a function of its own, so that the tick around it stays small."""
    compiled: Kernel = numba.njit(error_model="numpy")(function)
    return named(compiled, function)


def named(compiled: Kernel, function: Callable[..., Any]) -> Kernel:
    """Give a kernel a name that is the same in every process: by it numba's cache knows what a closure holds.

    Its own names are random, and would have kernels made inside a function compiled anew in each process.
    """
    held = [cell.cell_contents for cell in function.__closure__ or ()]
    told = [getattr(each, "_uuid", each) for each in held]
    compiled._set_uuid(f"{function.__module__}.{function.__qualname__} {told}")  # type: ignore[attr-defined]
    return compiled
