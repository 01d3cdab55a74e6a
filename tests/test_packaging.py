"""What is committed, what is locked and what an installation holds."""

import importlib.metadata
import importlib.resources
import json
import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
VENDOR_FILES = {"uPlot.esm.js", "uPlot.min.css", "swagger-ui-bundle.js", "swagger-ui.css", "favicon-32x32.png"}
HEAVY = {"control", "numba", "scipy"}
LOCKS = ("requirements.lock", "requirements-test.lock")


def pins(lock: str) -> set[str]:
    """The pinned lines of a lock, such as `scipy==1.17.1 ; python_full_version < '3.12'`."""
    text = (ROOT / lock).read_text("utf-8")
    return {line.removesuffix("\\").strip() for line in text.splitlines() if re.match(r"[a-z0-9]", line)}


def names(requirements: set[str] | list[str]) -> set[str]:
    return {canonicalize_name(Requirement(line).name) for line in requirements}


def tracked() -> list[str]:
    listing = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    return [name for name in listing.split("\0") if name]


@pytest.mark.parametrize("lock", LOCKS)
def test_a_lock_names_no_place_to_install_from(lock: str) -> None:
    text = (ROOT / lock).read_text("utf-8")
    assert "://" not in text
    assert not re.search(r"--(extra-)?index-url|--find-links|(^|\s)/\w", text)


def test_the_npm_lock_holds_hashes_and_no_registry() -> None:
    packages = json.loads((ROOT / "package-lock.json").read_text("utf-8"))["packages"]
    fetched = {name: entry for name, entry in packages.items() if name}
    assert fetched
    assert all(entry["integrity"].startswith("sha512-") for entry in fetched.values())
    assert not [name for name, entry in fetched.items() if "resolved" in entry]


@pytest.mark.parametrize("lock", LOCKS)
def test_every_locked_package_has_a_hash(lock: str) -> None:
    blocks = re.split(r"\n(?=[a-z0-9])", (ROOT / lock).read_text("utf-8"))[1:]
    assert len(blocks) == len(pins(lock))
    assert not [block.split()[0] for block in blocks if "--hash=sha256:" not in block]


def test_the_locks_hold_all_that_pyproject_asks_for() -> None:
    assert names(PROJECT["dependencies"]) <= names(pins("requirements.lock"))
    assert names(PROJECT["optional-dependencies"]["test"]) <= names(pins("requirements-test.lock"))


def test_tests_run_on_the_versions_that_users_get() -> None:
    assert pins("requirements.lock") <= pins("requirements-test.lock")


def test_nothing_third_party_is_tracked() -> None:
    files = tracked()
    foreign = re.compile(r"(^|/)(\.venv|venv|vendor|node_modules|site-packages|third_party)/|\.min\.(js|css)$|\.whl$")
    assert files
    assert not [name for name in files if foreign.search(name)][:10]


def test_no_tracked_file_is_large() -> None:
    paths = [ROOT / name for name in tracked()]
    assert not [path.name for path in paths if path.is_file() and path.stat().st_size > 1_000_000]


def test_the_installed_version_is_that_of_pyproject() -> None:
    assert importlib.metadata.version("vssea") == PROJECT["version"]


def test_the_page_finds_its_libraries_after_installation() -> None:
    vendor = importlib.resources.files("frontend_static") / "vendor"
    held = {item.name for item in vendor.iterdir() if item.is_file() and item.read_bytes()}
    assert held >= VENDOR_FILES


def test_a_wheel_holds_packages_page_and_libraries_and_nothing_else(tmp_path: Path) -> None:
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(tmp_path)]
    subprocess.run(build, cwd=ROOT, check=True, capture_output=True)
    (wheel,) = tmp_path.glob("*.whl")
    held = set(zipfile.ZipFile(wheel).namelist())
    assert held >= {f"frontend_static/vendor/{name}" for name in VENDOR_FILES} | {
        "backend/cli.py",
        "backend/store/migrations/env.py",
        "backend/store/migrations/versions/v0002_versions.py",
        "vssea_core/export/c/vssea_controller.c",
    }
    own = {"vssea_core", "backend", "frontend_static", f"vssea-{PROJECT['version']}.dist-info"}
    assert {name.split("/")[0] for name in held} == own
    assert not [name for name in held if "__pycache__" in name]


def test_the_help_of_the_command_loads_neither_compiler_nor_design_tools() -> None:
    command = Path(sys.executable).with_name("vssea")
    outcome = subprocess.run(
        [sys.executable, "-X", "importtime", str(command), "--help"], capture_output=True, text=True, check=True
    )
    loaded = {line.rsplit("|", 1)[1].strip().split(".")[0] for line in outcome.stderr.splitlines() if "|" in line}
    assert "serve" in outcome.stdout
    assert "typer" in loaded
    assert not loaded & HEAVY
