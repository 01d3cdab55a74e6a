"""The rigs that a server knows: TOML files of a folder, and the built-in ones."""

import tomllib
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from backend.problem import Problem, from_validation, refused
from backend.rigs.rig_file import RigFile

FOLDER = "rigs"
"""Where the rigs are, in the data folder."""
EMULATOR = "emulator"
BUILT_IN = (EMULATOR, "simulated")
"""Rigs that are always there and never changed: for `vssea emulator`, and one that needs no bus at all."""


@dataclass(frozen=True)
class RigEntry:
    """One rig: its file's text, and what is in it or why it cannot be used."""

    name: str
    builtin: bool
    text: str
    file: RigFile | None
    problem: str | None = None

    @property
    def address(self) -> str:
        """Where the bus is, in words; "" without a readable file."""
        if self.file is None:
            return ""
        bus = self.file.bus
        host, port = bus.options.get("host"), bus.options.get("port")
        return f"{bus.channel} at {host}:{port}" if host else bus.channel

    def document(self) -> dict[str, Any]:
        """Return the rig as the page lists it."""
        file = self.file
        return {
            "name": self.name,
            "note": file.note if file else "",
            "builtin": self.builtin,
            "file": file.model_dump(mode="json") if file else None,
            "problem": self.problem,
            "actuator": file.actuator if file else None,
            "rate_hz": file.rate_hz if file else None,
            "interface": file.bus.interface if file else None,
            "address": self.address,
        }


def example_text() -> str:
    """Return a commented rig file: two EPOS4 and an absolute encoder on a CAN card."""
    return (files("backend.rigs") / "example.toml").read_text("utf-8")


def rig_file_of(text: str) -> RigFile:
    """Return the rig that a TOML text describes. Raises Problem with what was expected."""
    try:
        return RigFile.model_validate(tomllib.loads(text))
    except tomllib.TOMLDecodeError as error:
        raise refused(f"The file is no TOML: {error}; `vssea rig example` writes one to begin with.") from error
    except ValidationError as error:
        problem = from_validation(error, RigFile)
        # A misspelt field is also a missing one; the misspelling is what helps.
        unknown = next((e for e in problem.errors if e.message.startswith("unknown")), None)
        raise (refused(f"{unknown.field}: {unknown.message}.", *problem.errors) if unknown else problem) from error


class RigLibrary:
    """Rigs by name, each in `folder`/name.toml; a file that cannot be used is listed with the reason."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def list(self) -> list[RigEntry]:
        """Return the built-in rigs and then the folder's, by name."""
        own = [self._entry(path.stem) for path in sorted(self.folder.glob("*.toml")) if path.stem not in BUILT_IN]
        return [*map(_builtin, BUILT_IN), *own]

    def get(self, name: str) -> RigEntry:
        """Return a rig. Raises Problem (404) where there is none."""
        entries = self.list()
        for entry in entries:
            if entry.name == name:
                return entry
        known = ", ".join(entry.name for entry in entries)
        raise Problem(404, "No such rig", f"There is no rig {name!r}; known: {known}.")

    def file(self, name: str) -> RigFile:
        """Return what a rig's file says. Raises Problem where there is none (404) or it cannot be used (422)."""
        entry = self.get(name)
        if entry.file is None:
            raise refused(f"Rig {name} cannot be used: {entry.problem}")
        return entry.file

    def put(self, name: str, text: str) -> RigEntry:
        """Keep a rig's file. Raises Problem where it is not right; what was there stays then."""
        _refuse_builtin(name, "changed; give yours another name")
        file = rig_file_of(text)
        if file.name != name:
            raise refused(f"The file's name is {file.name!r}, expected {name!r}; change one of them.")
        path = self._path(name)
        fresh = path.with_suffix(".new")
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            fresh.write_text(text, "utf-8")
            fresh.replace(path)
        except OSError as error:
            raise _disk(name, "written", error) from error
        return RigEntry(name, False, text, file)

    def delete(self, name: str) -> None:
        """Delete a rig's file. Raises Problem where there is none, or it is a built-in one."""
        _refuse_builtin(name, "deleted")
        self.get(name)
        try:
            self._path(name).unlink()
        except OSError as error:
            raise _disk(name, "deleted", error) from error

    def _path(self, name: str) -> Path:
        return self.folder / f"{name}.toml"

    def _entry(self, name: str) -> RigEntry:
        text = ""
        try:
            text = self._path(name).read_text("utf-8")
            file = rig_file_of(text)
        except (OSError, UnicodeDecodeError) as error:
            return RigEntry(name, False, text, None, f"The file cannot be read: {error}.")
        except Problem as problem:
            return RigEntry(name, False, text, None, problem.detail)
        if file.name != name:
            return RigEntry(name, False, text, None, f"The file's name is {file.name!r}, expected {name!r}.")
        return RigEntry(name, False, text, file)


def _builtin(name: str) -> RigEntry:
    text = (files("backend.rigs") / f"{name}.toml").read_text("utf-8")
    return RigEntry(name, True, text, rig_file_of(text))


def _refuse_builtin(name: str, what: str) -> None:
    if name in BUILT_IN:
        raise Problem(409, "Built-in rig", f"The built-in rig {name} cannot be {what}.")


def _disk(name: str, what: str, error: OSError) -> Problem:
    return Problem(507, "Not kept", f"Rig {name} cannot be {what}: {error.strerror or error}.")
