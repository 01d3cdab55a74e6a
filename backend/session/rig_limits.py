"""What may be asked of a rig: stiffness, disturbances, jogs and moves within its limits. Raises Problem, never clamps."""

from backend.problem import Problem, refused
from backend.rigs.rig_file import Limits, RigFile
from vssea_core.field_errors import FieldError
from vssea_core.scenario import Scenario
from vssea_core.signals.disturbance_documents import Disturbance
from vssea_core.signals.documents import Disturbances, StiffnessReference

UNCHANGED = "Nothing was changed."
NOISE_PEAK = 4.0
"""Peak of Gaussian noise in multiples of its RMS: passed for 6 samples of 100,000."""


def check_parts(rig: RigFile, new: Scenario, parts: list[str]) -> None:
    """Raise Problem if a changed part of the scenario asks for what the rig does not stand or cannot do."""
    if "stiffness_reference" in parts:
        check_stiffness(rig.limits, new.stiffness_reference)
    if "disturbances" in parts:
        check_disturbances(rig.limits, new.disturbances)


def check_stiffness(limits: Limits, reference: StiffnessReference) -> None:
    """Raise Problem if a commanded stiffness lies outside the rig's limits."""
    asked = {"stiffness": reference.stiffness}
    if reference.kind == "move":
        asked["target"] = reference.target
    for name, value in asked.items():
        if not limits.stiffness_low <= value <= limits.stiffness_high:
            expected = f"expected {limits.stiffness_low:g} to {limits.stiffness_high:g} N·m/rad, the rig's limits"
            error = FieldError(f"stiffness_reference.{name}", value, expected)
            raise refused(f"stiffness_reference.{name} is {value:g} N·m/rad; {expected}. {UNCHANGED}", error)


def check_disturbances(limits: Limits, asked: Disturbances) -> None:
    """Raise Problem unless all disturbances are torques that the motor can add to its own."""
    if asked.link or asked.stiffness_motor:
        side = "link" if asked.link else "stiffness motor"
        raise Problem(
            409, "Not on a rig",
            f"A rig's {side} meets what it meets: only torque that the motor adds, disturbances.motor, can be made. {UNCHANGED}",
        )  # fmt: skip
    most = sum(peak_torque(term) for term in asked.motor)
    if most > limits.motor_torque:
        raise refused(
            f"disturbances.motor add up to {most:g} N·m; expected at most {limits.motor_torque:g} N·m, the rig's torque limit. "
            f"{UNCHANGED}"
        )


def check_jog(limits: Limits, link: float, stiffness: float) -> None:
    """Raise Problem if a jog is faster than the rig's file allows."""
    for value, most, unit in (
        (link, limits.jog_speed, "rad/s"),
        (stiffness, limits.stiffness_jog, "N·m/rad a second"),
    ):
        if abs(value) > most * (1.0 + 1e-9):
            raise refused(f"A jog of {value:g} {unit} is too fast; expected at most {most:g} {unit}, the rig's limit.")


def check_move(limits: Limits, position: float, speed: float) -> None:
    """Raise Problem if a move ends outside the rig's limits or is faster than a jog may be."""
    if not limits.link_low <= position <= limits.link_high:
        raise refused(
            f"position is {position:g} rad; expected {limits.link_low:g} to {limits.link_high:g} rad, the rig's limits."
        )
    if speed > limits.jog_speed:
        raise refused(f"speed is {speed:g} rad/s; expected at most {limits.jog_speed:g} rad/s, the rig's limit.")


def peak_torque(term: Disturbance) -> float:
    """Return the largest torque [N m] of a disturbance."""
    match term.kind:
        case "constant" | "pulse":
            return abs(term.torque)
        case "multisine":
            return sum(component.amplitude for component in term.components)
        case "noise":
            return NOISE_PEAK * term.rms
        case _:
            return term.amplitude
