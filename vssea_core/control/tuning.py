"""What may change while the loop runs: controller, observer, stiffness loop and the controller's own model.

The model is not the plant: mismatch, Monte Carlo and identification live in the difference. Limits are not here; they
belong to the rig.
"""

from typing import Annotated, Literal

from pydantic import Field

from vssea_core.actuator.parameters import EquilibriumMotor, Link, StiffnessMechanism
from vssea_core.fields import Part, choice, kind, parameter


class StateFeedback(Part):
    """nu = r'''' + K^T e with the poles of (s^2 + 2 zeta p s + p^2)^2, Eq. (9) corrected."""

    kind: Literal["state_feedback"] = kind("state_feedback")
    natural_frequency: float = parameter(
        20.0, "poles", unit="rad/s", symbol="p", low=0.5, high=500.0, typical=(2.0, 60.0), step=0.1, scale="log",
        equation="(9)", meaning="Distance of the four closed-loop poles of the error state from the origin.",
    )
    damping: float = parameter(
        1.0, "pole damping", unit="", symbol="ζ", low=0.2, high=2.0, typical=(0.4, 1.2), step=0.01,
        equation="(9)", meaning="Damping ratio of both pole pairs; 1 puts all four at -p.",
    )


class SlidingMode(Part):
    """nu = r'''' + s1 e2 + s2 e3 + s3 e4 + rho switch(sigma), Eqs. (14)-(16) corrected."""

    kind: Literal["sliding_mode"] = kind("sliding_mode")
    surface_pole: float = parameter(
        20.0, "surface poles", unit="rad/s", symbol="λ", low=0.5, high=500.0, typical=(2.0, 60.0), step=0.1,
        scale="log", equation="(14)", meaning="Distance of the three poles of the sliding motion from the origin.",
    )
    switching_gain: float = parameter(
        5.0e4, "switching gain", unit="rad/s⁴", symbol="ρ", low=0.0, high=1e8, typical=(100.0, 1e6), step=100.0,
        scale="log", equation="(16)",
        meaning="Snap of the switching term; as torque it is ρ J_l J_e / k. With sgn it chatters by twice that, every sample.",
    )
    switch: Literal["layer", "sgn"] = choice(
        "layer", "switching", equation="(16)",
        meaning="layer: saturation inside a boundary layer, without chatter. sgn: as printed in the paper.",
    )
    layer_width: float = parameter(
        500.0, "boundary layer", unit="rad/s³", symbol="φ", low=1e-3, high=1e7, typical=(10.0, 1e5), step=1.0, scale="log",
        meaning="Half width of the boundary layer in σ; inside it the law is state feedback with gain ρ/φ, which needs ρ T/φ < 1.",
    )


class VelocityObserver(Part):
    """Second-order disturbance observer on velocities, Eqs. (20)-(24), in the variables d, d', d''."""

    kind: Literal["velocity"] = kind("velocity")
    bandwidth: float = parameter(
        100.0, "bandwidth", unit="rad/s", symbol="g", low=1.0, high=2000.0, typical=(10.0, 400.0), step=1.0, scale="log",
        equation="(20)-(22)", meaning="Triple pole of the estimation error. Not the same knob as the position form's g.",
    )
    discretisation: Literal["exact", "first_order_hold"] = choice(
        "exact", "discretisation", equation="(22)",
        meaning="exact: sampled so that disturbances up to degree 2 are estimated without error. "
        "first_order_hold: Eq. (22) with velocity and torque held to first order.",
    )
    velocity_source: Literal["measured", "difference"] = choice(
        "measured", "velocities",
        meaning="measured: the rig's velocity signals. difference: filtered differences of the encoders (noisy; for comparison).",
    )
    velocity_filter: float = parameter(
        1000.0, "velocity filter", unit="rad/s", symbol="ω_f", low=10.0, high=1e4, typical=(100.0, 3000.0), step=10.0,
        scale="log", meaning="Bandwidth of the filter behind the encoder difference.",
    )


class PositionObserver(Part):
    """The same disturbance model on measured positions: five states a channel, for rigs with encoders only."""

    kind: Literal["position"] = kind("position")
    bandwidth: float = parameter(
        100.0, "bandwidth", unit="rad/s", symbol="g", low=1.0, high=2000.0, typical=(10.0, 400.0), step=1.0, scale="log",
        meaning="Five-fold pole of the estimation error. Equal low-frequency error needs 2.15 times the velocity form's g.",
    )


class StiffnessLoop(Part):
    """PD with observer on the stiffness motor and its reference filter, Eq. (19) with the terms it lacks."""

    bandwidth: float = parameter(
        120.0, "stiffness loop bandwidth", unit="rad/s", symbol="ω", low=10.0, high=400.0, typical=(50.0, 200.0), step=1.0,
        equation="(19)", meaning="K_p = J_ms ω².",
    )
    damping: float = parameter(
        1.0, "stiffness loop damping", unit="", symbol="ζ", low=0.3, high=2.0, step=0.01, equation="(19)",
        meaning="K_d = 2 ζ ω J_ms - b_ms.",
    )
    observer_bandwidth: float = parameter(
        200.0, "stiffness observer bandwidth", unit="rad/s", symbol="g_ms", low=5.0, high=1000.0, typical=(50.0, 500.0),
        step=1.0, scale="log", meaning="Bandwidth of the stiffness motor's own disturbance observer.",
    )
    reference_bandwidth: float = parameter(
        40.0, "stiffness reference filter", unit="rad/s", symbol="ω_r", low=2.0, high=200.0, typical=(10.0, 100.0), step=1.0,
        meaning="Triple pole of the filter behind the commanded stiffness; it makes θ_ms'' continuous.",
    )
    torque_reserve: float = parameter(
        20.0, "torque for stiffness changes", unit="N·m", symbol="τ_r", low=0.5, high=1e6, typical=(2.0, 60.0), step=0.5,
        meaning="Motor torque a stiffness change under load may cost (3 J_e τ_s θ_ms''/(k θ_ms)); it changes slower above.",
    )


def _believed(owner: type[Part], field: str) -> object:
    """Return a copy of the plant's field: the model has the same meaning, unit and range."""
    return owner.model_fields[field]


class ControllerModel(Part):
    """The plant as the controller believes it to be."""

    link_inertia: float = _believed(Link, "inertia")  # type: ignore[assignment]
    link_damping: float = _believed(Link, "damping")  # type: ignore[assignment]
    motor_inertia: float = _believed(EquilibriumMotor, "inertia")  # type: ignore[assignment]
    motor_damping: float = _believed(EquilibriumMotor, "damping")  # type: ignore[assignment]
    spring_constant: float = _believed(StiffnessMechanism, "spring_constant")  # type: ignore[assignment]
    stiffness_inertia: float = _believed(StiffnessMechanism, "inertia")  # type: ignore[assignment]
    stiffness_damping: float = _believed(StiffnessMechanism, "damping")  # type: ignore[assignment]


Controller = Annotated[StateFeedback | SlidingMode, Field(discriminator="kind")]
Observer = Annotated[VelocityObserver | PositionObserver, Field(discriminator="kind")]


class Tuning(Part):
    """Everything a tuning changes; swapped whole between two ticks."""

    controller: Controller = StateFeedback()
    observer: Observer = VelocityObserver()
    stiffness_loop: StiffnessLoop = StiffnessLoop()
    model: ControllerModel = ControllerModel()
