"""Machine code is cached under a hash of all sources, so a change in a callee of another file is never overlooked."""

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

import vssea_core
from vssea_core.compiled import source_digest

PROBE = '''
"""A small cached kernel whose callee lives in another file."""

from vssea_core.actuator.spring import leaf
from vssea_core.compiled import entry


@entry
def stretched(deflection):
    return leaf(deflection, 50.0).torque
'''
PROGRAM = """
import vssea_core, vssea_core.compiled, vssea_core.probe
torque = vssea_core.probe.stretched(0.1)
hits = sum(vssea_core.probe.stretched.stats.cache_hits.values())
print(vssea_core.__file__, vssea_core.compiled.cache_folder(), hits, torque, sep="\\n")
"""


class Ran(NamedTuple):
    """What one process saw: the folder of its machine code, how often it was found there, and the kernel's result."""

    folder: str
    hits: int
    torque: float


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A copy of the package with a probe in it, free to be changed."""
    copy = tmp_path / "vssea_core"
    shutil.copytree(Path(vssea_core.__file__).parent, copy, ignore=shutil.ignore_patterns("__pycache__"))
    (copy / "probe.py").write_text(PROBE, encoding="utf-8")
    return copy


def run_in(package: Path) -> Ran:
    environment = os.environ | {"VSSEA_CACHE_DIR": str(package.parent / "cache"), "PYTHONPATH": str(package.parent)}
    command = [sys.executable, "-c", PROGRAM]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment, cwd=package.parent)
    file, folder, hits, torque = done.stdout.split()
    assert Path(file).parent == package, "the copy must be what runs"
    return Ran(folder, int(hits), float(torque))


def test_a_change_in_a_callee_of_another_file_reaches_the_cached_kernel(package: Path) -> None:
    first = run_in(package)
    again = run_in(package)
    assert (first.hits, again.hits) == (0, 1), "the second process takes the machine code from the cache"
    assert again[0::2] == first[0::2]

    spring = package / "actuator" / "spring.py"
    source = spring.read_text(encoding="utf-8")
    assert source.count("2.0 * q * c * per_cube") == 1
    spring.write_text(source.replace("2.0 * q * c * per_cube", "6.0 * q * c * per_cube"), encoding="utf-8")
    changed = run_in(package)
    assert changed.torque == pytest.approx(3.0 * first.torque)
    assert changed.hits == 0
    assert changed.folder != first.folder


def test_the_digest_follows_every_name_and_every_byte(package: Path) -> None:
    first = source_digest(package)
    assert source_digest(package) == first
    for source in sorted(package.rglob("*.py")):
        text = source.read_bytes()
        source.write_bytes(text + b"\n")
        assert source_digest(package) != first, source
        source.write_bytes(text)
    assert source_digest(package) == first
    (package / "signals" / "stiffness.py").rename(package / "signals" / "hardness.py")
    assert source_digest(package) != first
