"""A tuning tried in simulation before it drives the rig: beside the present one, on what the rig follows now."""

from typing import TYPE_CHECKING, Any

from backend.compute.pool import JobFailedError, JobRefusedError, Worker
from backend.problem import Problem
from backend.rigs.rig_file import RigFile
from backend.session.changes import Changes, with_changes
from backend.session.rig_arguments import Trial
from backend.telemetry.ring import EPOCH
from vssea_core.actuator.parameters import Actuator
from vssea_core.channels import INDEX
from vssea_core.scenario import Initial, Scenario
from vssea_core.signals.documents import ConstantStiffness, Disturbances, MoveReference, Reference

if TYPE_CHECKING:
    from backend.session.session import Session

Message = dict[str, Any]
DURATION_S = 4.0
MOVE = MoveReference(origin=0.0, target=0.2, duration_s=0.5, dwell_s=1.0, repeat=True, start_s=0.2)
TIME_LIMIT_S = 30.0


class TuningTrial:
    """Changes nothing; both are simulated from rest in the simulation worker."""

    def __init__(self, session: "Session", simulation: Worker) -> None:
        self._session, self._simulation = session, simulation

    async def run(self, asked: Trial, by: str) -> Message:
        """Return whether a changed tuning does well, in words and figures. Raises Problem if a value is out of range."""
        session = self._session
        present = self._scenario()
        candidate = with_changes(present, "tuning", Changes(changes=asked.changes))
        try:
            answer: Message = await self._simulation.run("try_tuning", present, candidate, time_limit_s=TIME_LIMIT_S)
        except JobRefusedError as refusal:
            sentence = str(refusal)
            why = f"{sentence[:1].upper()}{sentence[1:].rstrip('.')}."
            return {
                "ok": False,
                "sentence": why,
                "metrics": {},
                "limits": [],
                "margins": None,
                "rig": session.rig.name or None,
            }
        except JobFailedError as failure:
            raise Problem(503, "Not computed", f"The trial could not be computed: {failure}.") from failure
        return answer | {"rig": session.rig.name or None}

    def _scenario(self) -> Scenario:
        """Return the present tuning on the rig at rest: what it follows now, the stiffness that it has now."""
        session = self._session
        now, file = session.scenario, session.rig.file
        reference = self._reference()
        start = getattr(reference, "origin", getattr(reference, "offset", 0.0))
        return now.model_copy(update={
            "actuator": limited(now.actuator, file) if file is not None else now.actuator,
            "reference": reference,
            "stiffness_reference": ConstantStiffness(stiffness=self._stiffness()),
            "disturbances": Disturbances(),
            "sequence": (),
            "initial": Initial(link_position=start),
            "duration_s": DURATION_S,
        })  # fmt: skip

    def _reference(self) -> Reference:
        in_force = self._session.rig.state.in_force
        reference = in_force.reference if in_force is not None else self._session.scenario.reference
        rests = reference.kind == "jog" and reference.velocity == 0.0
        moves = in_force is None or self._session.status.state == "running"
        return reference if moves and not rests else MOVE

    def _stiffness(self) -> float:
        """Return the stiffness of now, within what may be commanded."""
        session = self._session
        newest, file = session.ring.latest(), session.rig.file
        mechanism, wanted = session.scenario.actuator.stiffness, session.scenario.stiffness_reference.stiffness
        value = float(newest[INDEX["stiffness"]]) if newest is not None else wanted
        if newest is None or newest[EPOCH] != session.status.epoch or not value > 0.0:
            value = wanted  # not measured: not homed, or not yet
        low, high = mechanism.softest, mechanism.stiffest
        if file is not None:
            low, high = file.limits.stiffness_low, file.limits.stiffness_high
        return min(max(value, low), high)


def limited(actuator: Actuator, rig: RigFile) -> Actuator:
    """Return an actuator whose drives give no more torque than the rig's limits let through."""
    motor, stiffness = actuator.motor, actuator.stiffness
    peak = min(motor.peak_torque, rig.limits.motor_torque)
    stiffness_peak = min(stiffness.peak_torque, rig.limits.stiffness_torque)
    return actuator.model_copy(update={
        "motor": motor.model_copy(
            update={"peak_torque": peak, "continuous_torque": min(motor.continuous_torque, peak)}
        ),
        "stiffness": stiffness.model_copy(
            update={
                "peak_torque": stiffness_peak,
                "continuous_torque": min(stiffness.continuous_torque, stiffness_peak),
            }
        ),
    })  # fmt: skip
