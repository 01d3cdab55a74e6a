"""Finds the C compiler of the tests of the exported controller; as a script, prints its path or ends with exit code 1."""

import os
import shutil
import sys

NAMES = ("cc", "gcc", "clang")


def find_compiler() -> str | None:
    """Path of the compiler that $CC names, else of the first known one on PATH."""
    chosen = os.environ.get("CC")
    return next((path for name in ([chosen] if chosen else NAMES) if (path := shutil.which(name))), None)


if __name__ == "__main__":
    found = find_compiler()
    sys.stdout.write(f"{found}\n" if found else "")
    sys.exit(0 if found else 1)
