"""The scenarios behind each panel of Figs. 2-4, by name. The paper gives no numbers: these are ours, from `paper_fig2`.

Figs. 2 and 3 are simulated as the paper simulates: the model is the plant, velocities are measured, the torque has no limit.
Fig. 4 shows experiments; here it is a simulated rig with encoders, dry friction, limits, lag and one sample of delay.
"""

from typing import Any, Literal, TypeVar

from vssea_core.control.tuning import (
    Baseline,
    Controller,
    NoObserver,
    Observer,
    PositionObserver,
    Schedule,
    SlidingMode,
    StateFeedback,
)
from vssea_core.fields import Part
from vssea_core.scenario import Scenario
from vssea_core.scenarios import PAPER_FIG2, REALISTIC
from vssea_core.signals.documents import ConstantStiffness, Disturbances, Reference, SineReference, StepReference

Document = TypeVar("Document", bound=Part)
Task = Literal["regulation", "tracking"]
TASKS: tuple[Task, ...] = ("regulation", "tracking")
TORQUE_WEIGHTS = (1e-3, 1e-1, 1.0, 10.0)
"""Weights of the torque for the LQR "tuned solely for performance", from fast to slow; 0.1 is that of the figures."""
AS_FAST_AS_POLES = 0.03
"""Weight of the torque with which the LQR rises about as fast as pole placement."""
STIFFNESSES = (50.0, 200.0, 800.0)  # N m/rad

DISTURBED_S, UNDISTURBED_S = 3.0, 10.0
"""When disturbances begin [s], and when they end in Fig. 4."""
SET_POINT, RIG_SET_POINT = 1.0, 0.5  # rad
AMPLITUDE = 0.5  # rad
POLE, RIG_POLE = 8.0, 20.0  # rad/s
LIMITED_TORQUE = 74.0  # N m
_UNLIMITED_TORQUE = 1e4
DESCRIPTION = "Of the paper's figures; the numbers are ours (see docs/paper.md)."
_BANDWIDTH_FOLLOWS_STIFFNESS = 0.35


def paper_scenarios() -> dict[str, Scenario]:
    """Return every scenario that the figures and claims use, by name, such as `fig3a_lqr_tracking`."""
    found = _of_fig2() | _of_fig3() | _of_fig4()
    return {name: _with(scenario, name=name, description=DESCRIPTION) for name, scenario in found.items()}


def _of_fig2() -> dict[str, Scenario]:
    """Fig. 2: u = -K x + N_r r on (A, B) of Eq. (5), without observer."""
    poles = Baseline(natural_frequency=POLE)
    lqr = Baseline(design="lqr_plant", natural_frequency=POLE)
    found = _disturbed_and_not("fig2a", poles, NoObserver()) | _disturbed_and_not("fig2b", lqr, NoObserver())
    found["fig2a_regulation_limited"] = _simulation("regulation", poles, NoObserver(), torque=LIMITED_TORQUE)
    faster = _with(lqr, torque_weight=AS_FAST_AS_POLES)
    found["fig2b_regulation_faster"] = _simulation("regulation", faster, NoObserver())
    return found


def _of_fig3() -> dict[str, Scenario]:
    """Fig. 3: the observer added, with K of the same closed-loop poles."""
    observer = PAPER_FIG2.tuning.observer
    by_poles = StateFeedback(natural_frequency=POLE)
    by_lqr = StateFeedback(design="lqr_plant", natural_frequency=POLE)
    found = _disturbed_and_not("fig3a_poles", by_poles, observer) | _disturbed_and_not("fig3a_lqr", by_lqr, observer)
    for design, controller in (("poles", by_poles), ("lqr", by_lqr)):
        name = f"fig3a_{design}_regulation_limited"
        found[name] = _simulation("regulation", controller, observer, torque=LIMITED_TORQUE)
    for weight in TORQUE_WEIGHTS:
        tuned = _with(by_lqr, torque_weight=weight)
        found[f"fig3a_lqr_regulation_weight_{weight:g}"] = _simulation("regulation", tuned, observer)
    for stiffness in STIFFNESSES:
        found[f"fig3a_poles_regulation_undisturbed_k{stiffness:g}"] = _with(
            _simulation("regulation", by_poles, observer, disturbed=False),
            stiffness_reference=ConstantStiffness(stiffness=stiffness),
        )
    return found


def _of_fig4() -> dict[str, Scenario]:
    """Fig. 4: both robust controllers, disturbed from 3 to 10 s; nominal, and on the rig at each stiffness."""
    found = {}
    controllers: dict[str, Controller] = {
        "fig4a": StateFeedback(natural_frequency=RIG_POLE),
        "fig4b": SlidingMode(surface_pole=RIG_POLE, switching_gain=2.5e4, layer_width=500.0),  # calm behind encoders
    }
    for panel, controller in controllers.items():
        for task in TASKS:
            found[f"{panel}_{task}_nominal"] = _experiment(PAPER_FIG2, task, controller, PAPER_FIG2.tuning.observer)
            on_rig = _experiment(_rig(), task, controller, PositionObserver(bandwidth=100.0))
            found[f"{panel}_{task}"] = on_rig
        for stiffness in STIFFNESSES:  # on the rig, the sine
            found[f"{panel}_tracking_k{stiffness:g}"] = _with(
                found[f"{panel}_tracking"], stiffness_reference=ConstantStiffness(stiffness=stiffness)
            )
    return found


def _disturbed_and_not(name: str, controller: Controller, observer: Observer) -> dict[str, Scenario]:
    return {
        f"{name}_{task}{suffix}": _simulation(task, controller, observer, disturbed=not suffix)
        for task in TASKS
        for suffix in ("", "_undisturbed")
    }


def _simulation(
    task: Task,
    controller: Controller,
    observer: Observer,
    *,
    disturbed: bool = True,
    torque: float = _UNLIMITED_TORQUE,
) -> Scenario:
    limits = {"peak_torque": torque, "continuous_torque": torque}
    return _with(
        PAPER_FIG2,
        actuator=_with(PAPER_FIG2.actuator, motor=_with(PAPER_FIG2.actuator.motor, **limits)),
        tuning=_with(PAPER_FIG2.tuning, controller=controller, observer=observer),
        reference=_reference(task, SET_POINT),
        disturbances=PAPER_FIG2.disturbances if disturbed else Disturbances(),
        duration_s=10.0,
    )


def _experiment(base: Scenario, task: Task, controller: Controller, observer: Observer) -> Scenario:
    on = {
        side: tuple(_with(term, end_s=UNDISTURBED_S) for term in getattr(base.disturbances, side))
        for side in ("link", "motor")
    }
    tuning = _with(
        base.tuning,
        controller=controller,
        observer=observer,
        schedule=Schedule(bandwidth_exponent=_BANDWIDTH_FOLLOWS_STIFFNESS),
    )
    return _with(
        base, tuning=tuning, reference=_reference(task, RIG_SET_POINT), disturbances=Disturbances(**on), duration_s=12.0
    )


def _rig() -> Scenario:
    """Return `paper_fig2` with the sensors, timing, limits, friction and lag of `realistic`."""
    plant = PAPER_FIG2.actuator
    motor = _with(REALISTIC.actuator.motor, inertia=plant.motor.inertia, damping=plant.motor.damping)
    return _with(PAPER_FIG2, actuator=_with(plant, motor=motor), sensors=REALISTIC.sensors, timing=REALISTIC.timing)


def _reference(task: Task, set_point: float) -> Reference:
    if task == "regulation":
        return StepReference(target=set_point, start_s=0.0, repeat=False)
    return SineReference(amplitude=AMPLITUDE, frequency_hz=0.25)


def _with(part: Document, **values: Any) -> Document:
    """Return a copy of `part` with other values."""
    return part.model_copy(update=values)
