"""The scenario of a rig: its actuator and sensors, its timing, and the tuning that it begins with."""

import math

from backend.problem import refused
from backend.rigs.rig_file import RigFile
from vssea_core.actuator.parameters import Actuator, Sensors, Timing
from vssea_core.control.tuning import ControllerModel, PositionObserver, StateFeedback, Tuning
from vssea_core.scenario import Scenario
from vssea_core.scenarios import REALISTIC
from vssea_core.signals.documents import ConstantStiffness, Disturbances, JogReference

DURATION_S = 10.0
FULL_RATE_HZ = 500.0
CAUTIOUS_POLES, CAUTIOUS_BANDWIDTH = 10.0, 60.0
"""rad/s; calm over the whole range of stiffness at 500 Hz."""
REST = JogReference(velocity=0.0)
"""Hold where it is."""


def rig_scenario(rig: RigFile, actuator: Actuator, tuning: Tuning, stiffness: float) -> Scenario:
    """Return the scenario of a rig at rest, undisturbed, at the stiffness [N m/rad] nearest to `stiffness` that it stands.

    Raises Problem if the rig's file asks for what its actuator or the controller cannot do.
    """
    limits, mechanism = rig.limits, actuator.stiffness
    if limits.stiffness_low < mechanism.softest or limits.stiffness_high > mechanism.stiffest:
        raise refused(
            f"The limits of rig {rig.name} are {limits.stiffness_low:g} to {limits.stiffness_high:g} N·m/rad, and its actuator "
            f"has end stops at {mechanism.softest:g} and {mechanism.stiffest:g} N·m/rad; narrow the limits in its file."
        )
    return Scenario(
        name=f"rig {rig.name}",
        description=rig.note,
        actuator=actuator,
        sensors=rig_sensors(rig),
        timing=Timing(sample_time_s=1.0 / rig.rate_hz, compute_delay_samples=1),
        tuning=tuning,
        reference=REST,
        stiffness_reference=ConstantStiffness(
            stiffness=min(max(stiffness, limits.stiffness_low), limits.stiffness_high)
        ),
        disturbances=Disturbances(),
        duration_s=DURATION_S,
    )


def rig_sensors(rig: RigFile) -> Sensors:
    """Return the encoders of a rig; it measures no velocities."""
    return Sensors(
        link_bits=round(math.log2(rig.link.counts_per_turn)),
        motor_counts=rig.motor.counts_per_turn,
        stiffness_counts=rig.stiffness.counts_per_turn,
        velocities=False,
    )


def cautious_tuning(rate_hz: float, actuator: Actuator) -> Tuning:
    """Return a tuning to begin with: the actuator as model, slow poles, a slow observer; slower still below 500 Hz."""
    share = min(1.0, rate_hz / FULL_RATE_HZ)
    loop = REALISTIC.tuning.stiffness_loop
    slower = {name: share * getattr(loop, name) for name in ("bandwidth", "observer_bandwidth", "reference_bandwidth")}
    return REALISTIC.tuning.model_copy(update={
        "controller": StateFeedback(natural_frequency=share * CAUTIOUS_POLES),
        "observer": PositionObserver(bandwidth=share * CAUTIOUS_BANDWIDTH),
        "stiffness_loop": loop.model_copy(update=slower),
        "model": model_of(actuator),
    })  # fmt: skip


def model_of(actuator: Actuator) -> ControllerModel:
    """Return what the controller believes if it believes the actuator's document."""
    link, motor, mechanism = actuator.link, actuator.motor, actuator.stiffness
    return ControllerModel(
        link_inertia=link.inertia,
        link_damping=link.damping,
        motor_inertia=motor.inertia,
        motor_damping=motor.damping,
        spring_constant=mechanism.spring_constant,
        stiffness_inertia=mechanism.inertia,
        stiffness_damping=mechanism.damping,
    )


def unfit_because(tuning: Tuning) -> str | None:
    """Return why a tuning cannot run where no velocities are measured, None if it can."""
    if isinstance(tuning.observer, PositionObserver):
        return None
    return f"it has no position observer (its observer is {tuning.observer.kind})"
