"""Scenarios whose controllers together use every branch of the tick."""

from typing import Any

from vssea_core.actuator.parameters import Timing
from vssea_core.control.tuning import (
    Baseline,
    NoObserver,
    PositionObserver,
    Schedule,
    SlidingMode,
    StateFeedback,
    StiffnessLoop,
    Tuning,
    VelocityObserver,
)
from vssea_core.scenario import Scenario
from vssea_core.scenarios import NOMINAL, PAPER_FIG2, REALISTIC

DELAYED = Timing(compute_delay_samples=1)


def tuned(base: Scenario = NOMINAL, timing: Timing | None = None, **tuning: Any) -> Scenario:
    """The scenario with other parts of the tuning."""
    changed = base.tuning.model_copy(update=tuning)
    return base.model_copy(
        update={"tuning": Tuning.model_validate(changed.model_dump()), "timing": timing or base.timing}
    )


TUNINGS: dict[str, Scenario] = {
    "nominal": NOMINAL,
    "realistic": REALISTIC,
    "paper_fig2": PAPER_FIG2,
    "lqr_chain": tuned(controller=StateFeedback(design="lqr_chain")),
    "lqr_plant": tuned(controller=StateFeedback(design="lqr_plant")),
    "sampled": tuned(controller=StateFeedback(natural_frequency=8.0, sampled=True)),
    "layer": tuned(controller=SlidingMode()),
    "tanh": tuned(controller=SlidingMode(switch="tanh")),
    "super_twisting": tuned(controller=SlidingMode(switch="super_twisting")),
    "sgn": tuned(controller=SlidingMode(switch="sgn", switching_gain=500.0)),
    "baseline": tuned(controller=Baseline(natural_frequency=8.0)),
    "baseline_lqr": tuned(controller=Baseline(design="lqr_plant"), observer=NoObserver()),
    "first_order_hold": tuned(observer=VelocityObserver(discretisation="first_order_hold")),
    "butterworth": tuned(observer=VelocityObserver(shape="butterworth", bandwidth=60.0)),
    "difference": tuned(REALISTIC, observer=VelocityObserver(velocity_source="difference", velocity_filter=300.0)),
    "kalman": tuned(REALISTIC, observer=PositionObserver(shape="kalman")),
    "off": tuned(observer=NoObserver(), controller=StateFeedback(natural_frequency=8.0)),
    "off_difference": tuned(observer=NoObserver(velocity_source="difference"), controller=Baseline(natural_frequency=4.0)),
    "predict_velocity": tuned(timing=DELAYED, observer=VelocityObserver(predict=True)),
    "predict_position": tuned(REALISTIC, observer=PositionObserver(predict=True)),
    "predict_without_delay": tuned(observer=VelocityObserver(predict=True)),
    "rate_term": tuned(REALISTIC, stiffness_loop=StiffnessLoop(terms="rate")),
    "no_terms": tuned(REALISTIC, stiffness_loop=StiffnessLoop(terms="none")),
    "schedule": tuned(REALISTIC, schedule=Schedule(poles_exponent=0.25, bandwidth_exponent=0.35)),
    "schedule_sliding_predict": tuned(
        REALISTIC, controller=SlidingMode(switch="super_twisting"), observer=PositionObserver(predict=True),
        schedule=Schedule(poles_exponent=0.25, bandwidth_exponent=0.35),
    ),
}  # fmt: skip
