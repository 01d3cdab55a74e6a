"""What is kept of a fault: the samples before it and the scenario that led there, in one file."""

from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from backend.telemetry.ring import WIDTH, Piece
from vssea_core.channels import CHANNELS
from vssea_core.scenario import Scenario


def save_fault_snapshot(data_dir: Path, piece: Piece, scenario: Scenario, reason: str | None) -> Path:
    """Write samples (n, channels), channel names, scenario and reason to a .npz file and return its path."""
    folder = data_dir / "faults"
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"{datetime.now(UTC):%Y-%m-%dT%H-%M-%S-%f}.npz"
    np.savez_compressed(
        file,
        samples=piece.samples[:, :WIDTH],
        channels=np.array([channel.name for channel in CHANNELS]),
        scenario=np.array(scenario.model_dump_json()),
        reason=np.array(reason or ""),
    )
    return file
