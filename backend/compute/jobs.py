"""What the workers can do. Imports the design tools and the compiler; the web process never imports this module."""

import csv
import io
import json
import tempfile
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from backend.compute.analysis_jobs import analyse_loop, analysis_task, margins_of
from backend.compute.calibration_job import calibrate
from backend.compute.report_jobs import paper_task
from backend.compute.trial_job import compared_tunings
from backend.telemetry.frames import frames
from backend.telemetry.ring import COLUMNS, EPOCH, PERIOD_S, WIDTH, Piece
from vssea_core.analysis.refusal import unstable_because
from vssea_core.channels import CHANNELS, INDEX
from vssea_core.control.tuning import Tuning
from vssea_core.export import bundle
from vssea_core.scenario import Scenario, after_changes
from vssea_core.simulation.events import event_metrics
from vssea_core.simulation.metrics import limit_shares, metrics
from vssea_core.simulation.plan import PreparedRun
from vssea_core.simulation.run import prepare_scenario, simulate
from vssea_core.simulation.trajectory import Trajectory

__all__ = [
    "LONG",
    "analyse_loop",
    "analysis_task",
    "calibrate",
    "margins_of",
    "paper_task",
    "plan_run",
    "simulate_rows",
    "simulate_scenario",
    "simulate_to_file",
    "try_tuning",
]

LONG = frozenset({"analysis_task", "paper_task"})
"""Jobs that tell their progress and can be cancelled; see compute.worker."""


def plan_run(scenario: Scenario) -> PreparedRun:
    """Return the numbers of the scenario's tunings. Raises ValueError if a sampled loop is unstable by its own model."""
    refuse_unstable(scenario)
    return prepare_scenario(scenario)


def refuse_unstable(scenario: Scenario) -> None:
    """Raise ValueError with the reason and a remedy if the tuning is unstable at a stiffness the scenario commands."""
    for _, after in after_changes(scenario):
        refuse_unstable(after)
    reference = scenario.stiffness_reference
    asked = {reference.stiffness, reference.target} if reference.kind == "move" else {reference.stiffness}
    for stiffness in sorted(asked):
        tuning: Tuning = scenario.tuning
        sentence = unstable_because(tuning, scenario.timing, scenario.actuator.motor.torque_lag_s, stiffness)
        if sentence:
            raise ValueError(sentence)


def simulate_scenario(scenario: Scenario, form: str, every: int, allow_unstable: bool) -> tuple[str, bytes]:
    """Return media type and body of a simulation: form `none`, `json`, `csv` or `binary`, every `every`-th sample."""
    if not allow_unstable:
        refuse_unstable(scenario)
    trajectory = simulate(scenario)
    thinned = trajectory.rows[::every]
    if form == "csv":
        return "text/csv; charset=utf-8", _as_csv(thinned)
    if form == "binary":
        return "application/octet-stream", _as_frames(thinned, trajectory.period_s * every)
    answer = summary(scenario, trajectory)
    if form == "json":
        answer["trajectory"] = {channel.name: thinned[:, INDEX[channel.name]].tolist() for channel in CHANNELS}
        answer["period_s"] = trajectory.period_s * every
    return "application/json", json.dumps(answer, ensure_ascii=False, allow_nan=False).encode()


def simulate_to_file(scenario: Scenario, form: str, every: int, allow_unstable: bool, folder: str) -> tuple[str, str]:
    """Return media type and the path, in `folder`, of what simulate_scenario returns.

    A trajectory is too much for the pipe: its bytes would pass through the web process in one piece.
    """
    media_type, content = simulate_scenario(scenario, form, every, allow_unstable)
    with tempfile.NamedTemporaryFile(dir=folder, delete=False) as file:
        file.write(content)
    return media_type, file.name


def simulate_rows(scenario: Scenario, tuning_id: int, folder: str) -> str:
    """Return the path, in `folder`, of all rows (samples, channels) of a simulation as a .npy file; see core's simulate."""
    with tempfile.NamedTemporaryFile(dir=folder, suffix=".npy", delete=False) as file:
        np.save(file, simulate(scenario, tuning_id).rows)
    return file.name


def try_tuning(present: Scenario, candidate: Scenario) -> dict[str, Any]:
    """Return how a tuning does beside the present one, with its margins. Raises ValueError if its own loop is unstable."""
    refuse_unstable(candidate)
    return compared_tunings(present, candidate) | {"margins": margins_of(candidate)}


def export_controller(scenario: Scenario, form: str) -> tuple[str, bytes]:
    """Return media type and body of the scenario's controller: form `json`, `mat`, or `c`, a zip of the C files with vectors.

    Raises ValueError if the tuning's loop is unstable by its own model or a design has no solution.
    """
    refuse_unstable(scenario)
    if form == "json":
        return "application/json", bundle.json_file(scenario)
    if form == "mat":
        return "application/x-matlab-data", bundle.mat_file(scenario)
    return "application/zip", bundle.zipped(bundle.c_files(scenario))


def export_all(scenario: Scenario) -> dict[str, bytes]:
    """Return all files of an export by name. Raises ValueError as `export_controller`."""
    refuse_unstable(scenario)
    return bundle.all_files(scenario)


def summary(scenario: Scenario, trajectory: Trajectory) -> dict[str, Any]:
    """Return the metrics, the active limits and how the run ended."""
    return {
        "name": scenario.name,
        "samples": len(trajectory),
        "ending": trajectory.ending,
        "metrics": metrics(trajectory.rows),
        "limits": limit_shares(trajectory.rows),
        "events": [asdict(event) for event in event_metrics(scenario, trajectory.rows)],
    }


def _as_csv(rows: NDArray[np.float64]) -> bytes:
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow([f"{channel.name} [{channel.unit}]" if channel.unit else channel.name for channel in CHANNELS])
    writer.writerows(rows.tolist())
    return text.getvalue().encode()


def _as_frames(rows: NDArray[np.float64], period_s: float) -> bytes:
    samples = np.zeros((len(rows), COLUMNS))
    samples[:, :WIDTH] = rows
    samples[:, EPOCH] = 1
    samples[:, PERIOD_S] = period_s
    return b"".join(frames(Piece(0, samples)))
