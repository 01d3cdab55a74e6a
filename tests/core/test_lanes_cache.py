"""A process finds the machine code of lanes that another one has compiled: what they are kept under is the same in both."""

import subprocess
import sys
from pathlib import Path

KEYS = """
from hashlib import sha256
from numba.core.serialize import dumps
from vssea_core.batch.lanes import Variant, lanes_kernel
for place in range(3):
    kernel = lanes_kernel(Variant(*(place == each for each in range(6))))
    print(sha256(dumps([cell.cell_contents for cell in kernel.py_func.__closure__])).hexdigest())
"""


def keys() -> list[str]:
    root = Path(__file__).parents[2]
    run = subprocess.run([sys.executable, "-c", KEYS], cwd=root, capture_output=True, text=True, check=True)
    return run.stdout.split()


def test_a_kernel_is_kept_under_the_same_key_by_every_process_and_each_variant_under_its_own() -> None:
    first = keys()
    assert first == keys()
    assert len(set(first)) == 3
