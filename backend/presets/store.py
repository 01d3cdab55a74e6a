"""Presets in SQLite: a name, when it was saved, and the tuning as JSON."""

import json
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import sqlalchemy as sa
from pydantic import ValidationError

from backend.problem import Problem
from vssea_core.control.tuning import Tuning
from vssea_core.scenario import Scenario

_tables = sa.MetaData()
_presets = sa.Table(
    "presets",
    _tables,
    sa.Column("name", sa.String(80), primary_key=True),
    sa.Column("saved_at", sa.String(40), nullable=False),
    sa.Column("tuning", sa.Text, nullable=False),
)
_last = sa.Table(
    "last", _tables,
    sa.Column("id", sa.Integer, primary_key=True),
    sa.Column("scenario", sa.Text, nullable=False),
    sa.Column("preset", sa.String(80), nullable=True),
)  # fmt: skip


@dataclass(frozen=True)
class Preset:
    """A named tuning."""

    name: str
    saved_at: str
    tuning: Tuning

    def document(self) -> dict[str, Any]:
        """Return it as JSON takes it."""
        return {"name": self.name, "saved_at": self.saved_at, "tuning": self.tuning.model_dump(mode="json")}


@dataclass(frozen=True)
class Last:
    """What ran when the server ended."""

    scenario: Scenario
    preset: str | None


class PresetStore:
    """All methods block on the disk for a moment; the web process calls them in a thread."""

    def __init__(self, data_dir: Path) -> None:
        data_dir.mkdir(parents=True, exist_ok=True)
        self._engine = sa.create_engine(f"sqlite:///{data_dir / 'vssea.sqlite'}")
        _tables.create_all(self._engine)
        self._known: dict[str, Preset] = {preset.name: preset for preset in self._load()}

    def _load(self) -> list[Preset]:
        with self._engine.connect() as connection:
            rows = connection.execute(sa.select(_presets)).all()
        presets = []
        for row in rows:
            try:
                presets.append(Preset(row.name, row.saved_at, Tuning.model_validate_json(row.tuning)))
            except ValidationError:
                continue  # written by a version with other fields: it stays in the file
        return presets

    def list(self) -> list[Preset]:
        """Return all presets, newest first."""
        return sorted(self._known.values(), key=lambda preset: preset.saved_at, reverse=True)

    def known(self, name: str) -> Preset | None:
        """Return a preset from memory, or None."""
        return self._known.get(name)

    def get(self, name: str) -> Preset:
        """Return a preset. Raises Problem if there is none of this name."""
        preset = self._known.get(name)
        if preset is None:
            names = ", ".join(self._known) or "none saved yet"
            raise Problem(404, "No such preset", f"There is no preset {name!r}; known: {names}.")
        return preset

    def save(self, name: str, tuning: Tuning) -> Preset:
        """Save or replace a preset and return it."""
        preset = Preset(name, datetime.now(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z"), tuning)
        with self._engine.begin() as connection:
            connection.execute(sa.delete(_presets).where(_presets.c.name == name))
            values = {"name": name, "saved_at": preset.saved_at, "tuning": tuning.model_dump_json()}
            connection.execute(sa.insert(_presets).values(**values))
        self._known[name] = preset
        return preset

    def delete(self, name: str) -> None:
        """Delete a preset. Raises Problem if there is none of this name."""
        self.get(name)
        with self._engine.begin() as connection:
            connection.execute(sa.delete(_presets).where(_presets.c.name == name))
        del self._known[name]

    def save_last(self, scenario: Scenario, preset: str | None) -> None:
        """Keep what runs for the next start."""
        with self._engine.begin() as connection:
            connection.execute(sa.delete(_last))
            connection.execute(sa.insert(_last).values(id=1, scenario=scenario.model_dump_json(), preset=preset))

    def last(self) -> Last | None:
        """Return what ran when the server ended, or None at a first start or if it no longer fits."""
        with self._engine.connect() as connection:
            row = connection.execute(sa.select(_last)).first()
        if row is None:
            return None
        try:
            return Last(Scenario.model_validate(json.loads(row.scenario)), row.preset)
        except ValidationError:
            return None

    def close(self) -> None:
        """Let go of the file."""
        self._engine.dispose()
