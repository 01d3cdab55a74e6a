"""Which version of the model computes: rows of two versions may differ in bits, and are never mixed in one batch."""

import hashlib
from functools import cache
from importlib import metadata
from pathlib import Path

import vssea_core

PACKAGES = ("numba", "numpy", "scipy")
"""What the bits depend on besides the model's own sources: compiler, random numbers, design."""


@cache
def model_version() -> str:
    """Return a hash over the sources of vssea_core and the versions of what it calculates with; loads none of these."""
    package, digest = Path(vssea_core.__file__).parent, hashlib.sha256()
    for name in PACKAGES:
        digest.update(f"{name} {metadata.version(name)}\n".encode())
    for source in sorted(package.rglob("*.py")):
        digest.update(source.relative_to(package).as_posix().encode() + b"\0" + source.read_bytes())
    return digest.hexdigest()[:16]
