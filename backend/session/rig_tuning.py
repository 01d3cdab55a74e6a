"""The tuning that a rig begins with: of those that may be meant, the first that fits the rig."""

import asyncio
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from backend.presets.last import InForce
from backend.problem import Problem
from backend.rigs.rig_file import RigFile
from backend.session.planning import planned
from backend.session.rig_scenario import cautious_tuning, rig_scenario, unfit_because
from vssea_core.actuator.parameters import Actuator
from vssea_core.control.tuning import Tuning
from vssea_core.scenario import Scenario

if TYPE_CHECKING:
    from backend.session.session import Session

STIFFNESS = 200.0


@dataclass(frozen=True)
class Candidate:
    """A tuning that a rig may begin with; `name` says where it comes from."""

    name: str
    tuning: Tuning
    preset: InForce | None = None


@dataclass(frozen=True)
class Begun:
    """What a rig begins with; `words` say which tuning it is, and why not the one before it."""

    scenario: Scenario
    prepared: NDArray[np.float64]
    preset: InForce | None
    words: str


async def begun_scenario(session: "Session", rig: RigFile) -> Begun:
    """Return what a rig begins with. Raises Problem if its actuator is unknown or no tuning fits."""
    actuator = await asyncio.to_thread(actuator_of, session, rig)
    candidates, passed_over = await asyncio.to_thread(_candidates, session, rig, actuator)
    for candidate in candidates:
        why = unfit_because(candidate.tuning)
        if why is None:
            scenario = rig_scenario(rig, actuator, candidate.tuning, STIFFNESS)
            try:
                prepared = await planned(session.design, scenario)
            except Problem as problem:
                if problem.status != 422:
                    raise
                why = problem.detail.removesuffix(" The old tuning keeps running.").rstrip(".")
            else:
                words = f"it begins with {candidate.name}"
                because = f" ({'; '.join(passed_over)})" if passed_over else ""
                return Begun(scenario, prepared.prepared, candidate.preset, words + because)
        passed_over.append(f"not with {candidate.name}: {why}")
    raise Problem(
        409, "No tuning fits", f"No tuning fits rig {rig.name} at {rig.rate_hz} Hz: {'; '.join(passed_over)}."
    )


def _candidates(session: "Session", rig: RigFile, actuator: Actuator) -> tuple[list[Candidate], list[str]]:
    """Return what may be meant, and what is not to be had: the rig's own preset goes first, unless it was connected before."""
    found, missing = [], []
    if rig.preset is not None and not session.rig.connected:
        try:
            preset = session.presets.presets.get(rig.preset)
            found.append(Candidate(f"preset {rig.preset}", preset.content.tuning, InForce.of(preset)))
        except Problem as problem:
            missing.append(f"not with preset {rig.preset}: {problem.detail.rstrip('.')}")
    found.append(Candidate("the tuning that was in force", session.scenario.tuning, session.preset))
    found.append(Candidate("a cautious tuning", cautious_tuning(rig.rate_hz, actuator)))
    return found, missing


def actuator_of(session: "Session", rig: RigFile) -> Actuator:
    """Return the actuator that a rig's file names, the default one if it names none. Raises Problem 404; may wait for a disk."""
    if rig.actuator is None:
        return Actuator()
    actuator: Actuator = session.presets.actuators.get(rig.actuator).content.actuator
    return actuator
