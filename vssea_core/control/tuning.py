"""What may change while the loop runs: controller, observer, stiffness loop and the controller's own model.

The model is not the plant: mismatch, Monte Carlo and identification live in the difference. Limits are not here; they
belong to the rig.
"""

from typing import Annotated, Literal

from pydantic import Field

from vssea_core.actuator.parameters import EquilibriumMotor, Link, StiffnessMechanism
from vssea_core.fields import Part, choice, kind, parameter


def _poles(equation: str, meaning: str) -> float:
    field: float = parameter(
        20.0, "poles", unit="rad/s", symbol="p", low=0.5, high=500.0, typical=(2.0, 60.0), step=0.1, scale="log",
        equation=equation, meaning=meaning,
    )
    return field


def _pole_damping(equation: str) -> float:
    field: float = parameter(
        1.0, "pole damping", unit="", symbol="ζ", low=0.2, high=2.0, typical=(0.4, 1.2), step=0.01,
        equation=equation, meaning="Damping ratio of both pole pairs; 1 puts all four at -p.",
    )
    return field


def _weight(default: float, title: str, unit: str, symbol: str, typical: tuple[float, float], *, low: float = 0.0) -> float:
    field: float = parameter(
        default, title, unit=unit, symbol=symbol, low=low, high=1e12, typical=typical, step=typical[0] or typical[1] / 1000.0,
        scale="log" if typical[0] > 0.0 else "linear", meaning="Weight of the squared quantity in the LQR's cost.",
    )
    return field


class PlantWeights(Part):
    """Weights of an LQR on (A, B) of Eq. (5): Q = diag(q_1 .. q_4) on the plant's state, R on the motor torque."""

    link_position_weight: float = _weight(101.0, "link position weight", "1/rad²", "q_θl", (0.1, 1e5))
    link_velocity_weight: float = _weight(1.0, "link velocity weight", "s²/rad²", "q_ωl", (0.0, 100.0))
    motor_position_weight: float = _weight(1.0, "motor position weight", "1/rad²", "q_θe", (0.0, 100.0))
    motor_velocity_weight: float = _weight(1.0, "motor velocity weight", "s²/rad²", "q_ωe", (0.0, 100.0))
    torque_weight: float = _weight(0.1, "torque weight", "1/(N·m)²", "r_τ", (1e-5, 10.0), low=1e-12)


class StateFeedback(PlantWeights):
    """nu = r'''' + K^T e, Eq. (9) corrected; K by poles, or by an LQR on the error chain or on the plant (5)."""

    kind: Literal["state_feedback"] = kind("state_feedback")
    design: Literal["poles", "lqr_chain", "lqr_plant"] = choice(
        "poles", "design", equation="(9)",
        meaning="poles: of (s² + 2ζps + p²)². lqr_chain: LQR on the error state. "
        "lqr_plant: the closed-loop poles of an LQR on (A, B) of Eq. (5), so they follow the stiffness.",
    )
    sampled: bool = choice(
        False, "exact sampling", equation="(9)",
        meaning="Place the poles of the sampled loop, with the torque held over a sample, at exp(pT) exactly; "
        "without it a quadruple pole splits.",
    )
    natural_frequency: float = _poles("(9)", "Distance of the four closed-loop poles of the error state from the origin.")
    damping: float = _pole_damping("(9)")
    error_weight: float = _weight(1.0, "error weight", "1/rad²", "q₁", (1e-3, 1e3))
    error_velocity_weight: float = _weight(2.5e-3, "velocity error weight", "s²/rad²", "q₂", (0.0, 0.05))
    error_acceleration_weight: float = _weight(0.0, "acceleration error weight", "s⁴/rad²", "q₃", (0.0, 1e-3))
    error_jerk_weight: float = _weight(0.0, "jerk error weight", "s⁶/rad²", "q₄", (0.0, 1e-6))
    snap_weight: float = _weight(4e-11, "snap weight", "s⁸/rad²", "r_ν", (1e-15, 1e-5), low=1e-24)


class SlidingMode(Part):
    """nu = r'''' + s1 e2 + s2 e3 + s3 e4 + rho switch(sigma), Eqs. (14)-(16) corrected."""

    kind: Literal["sliding_mode"] = kind("sliding_mode")
    surface_pole: float = parameter(
        20.0, "surface poles", unit="rad/s", symbol="λ", low=0.5, high=500.0, typical=(2.0, 60.0), step=0.1,
        scale="log", equation="(14)", meaning="Distance of the three poles of the sliding motion from the origin.",
    )
    switch: Literal["layer", "tanh", "super_twisting", "sgn"] = choice(
        "layer", "switching", equation="(16)",
        meaning="layer: saturation inside a boundary layer, without chatter. tanh: the same, smooth. super_twisting: continuous, "
        "with an integral. sgn: as printed in the paper; it chatters.",
    )
    switching_gain: float = parameter(
        5.0e4, "switching gain", unit="rad/s⁴", symbol="ρ", low=0.0, high=1e8, typical=(100.0, 1e6), step=100.0,
        scale="log", equation="(16)",
        meaning="Snap of the switching term; as torque it is ρ J_l J_e / k. With sgn it chatters by twice that, every sample.",
    )
    layer_width: float = parameter(
        500.0, "boundary layer", unit="rad/s³", symbol="φ", low=1e-3, high=1e7, typical=(10.0, 1e5), step=1.0, scale="log",
        meaning="Half width of the boundary layer in σ; inside it the law is state feedback with gain ρ/φ, which needs ρ T/φ < 1.",
    )
    twisting_gain: float = parameter(
        1.0e4, "super-twisting gain", unit="rad/s⁵", symbol="L", low=1.0, high=1e9, typical=(100.0, 1e6), step=100.0,
        scale="log", meaning="Bound on the rate of what is left of the disturbance: ν += 1.5 √(L|σ|) sgn σ + w, w' = 1.1 L sgn σ.",
    )


class Baseline(PlantWeights):
    """u = -K x + N_r r on (A, B) of Eq. (5): Fig. 2's controllers, which know no disturbance and no derivative of the reference."""

    kind: Literal["baseline"] = kind("baseline")
    design: Literal["poles", "lqr_plant"] = choice(
        "poles", "design", equation="(5)", meaning="poles: of (s² + 2ζps + p²)². lqr_plant: LQR on (A, B).",
    )
    natural_frequency: float = _poles("(5)", "Distance of the four closed-loop poles of the plant from the origin.")
    damping: float = _pole_damping("(5)")


_VELOCITY_SOURCE = "measured: the rig's velocity signals. difference: filtered differences of the encoders (noisy; for comparison)."


def _velocity_filter() -> float:
    field: float = parameter(
        1000.0, "velocity filter", unit="rad/s", symbol="ω_f", low=10.0, high=1e4, typical=(100.0, 3000.0), step=10.0,
        scale="log", meaning="Bandwidth of the filter behind the encoder difference.",
    )
    return field


def _predict() -> bool:
    field: bool = choice(
        False, "compensate the delay",
        meaning="The law acts on the state predicted over one sample of compute delay; without such a delay it changes nothing.",
    )
    return field


class VelocityObserver(Part):
    """Second-order disturbance observer on velocities, Eqs. (20)-(24), in the variables d, d', d''."""

    kind: Literal["velocity"] = kind("velocity")
    bandwidth: float = parameter(
        100.0, "bandwidth", unit="rad/s", symbol="g", low=1.0, high=2000.0, typical=(10.0, 400.0), step=1.0, scale="log",
        equation="(20)-(22)", meaning="Triple pole of the estimation error. Not the same knob as the position form's g.",
    )
    shape: Literal["multiple", "butterworth"] = choice(
        "multiple", "pole pattern", equation="(21)",
        meaning="multiple: triple pole at -g. butterworth: three poles on a circle of radius g, flatter and less damped.",
    )
    discretisation: Literal["exact", "first_order_hold"] = choice(
        "exact", "discretisation", equation="(22)",
        meaning="exact: sampled so that disturbances up to degree 2 are estimated without error. "
        "first_order_hold: Eq. (22) with velocity and torque held to first order.",
    )
    velocity_source: Literal["measured", "difference"] = choice("measured", "velocities", meaning=_VELOCITY_SOURCE)
    velocity_filter: float = _velocity_filter()
    predict: bool = _predict()


class PositionObserver(Part):
    """The same disturbance model on measured positions: five states a channel, for rigs with encoders only."""

    kind: Literal["position"] = kind("position")
    bandwidth: float = parameter(
        100.0, "bandwidth", unit="rad/s", symbol="g", low=1.0, high=2000.0, typical=(10.0, 400.0), step=1.0, scale="log",
        meaning="Five-fold pole of the estimation error. Equal low-frequency error needs 2.15 times the velocity form's g.",
    )
    shape: Literal["multiple", "kalman"] = choice(
        "multiple", "pole pattern",
        meaning="multiple: five-fold pole at -g. kalman: steady Kalman gain for white d''' and encoder noise whose ratio gives "
        "Butterworth poles of radius g.",
    )
    predict: bool = _predict()


class NoObserver(Part):
    """No disturbance estimate: d = d' = d'' = 0. The law then knows the plant's state alone."""

    kind: Literal["off"] = kind("off")
    velocity_source: Literal["measured", "difference"] = choice("measured", "velocities", meaning=_VELOCITY_SOURCE)
    velocity_filter: float = _velocity_filter()
    predict: bool = _predict()


class Schedule(Part):
    """Gains that follow the stiffness k: poles p (k/k_0)^a, observer bandwidth g (k/k_0)^b. Exponents of 0 hold them constant."""

    reference_stiffness: float = parameter(
        200.0, "at stiffness", unit="N·m/rad", symbol="k₀", low=1.0, high=1e5, typical=(20.0, 1000.0), step=1.0, scale="log",
        meaning="Stiffness at which poles and bandwidth are as set.",
    )
    poles_exponent: float = parameter(
        0.0, "poles follow stiffness", unit="", symbol="a", low=-1.0, high=1.0, typical=(0.0, 0.5), step=0.01,
        meaning="p (k/k₀)^a, for poles and surface poles. A snap costs J_l J_e/k of torque: slower poles keep a soft spring calm.",
    )
    bandwidth_exponent: float = parameter(
        0.0, "bandwidth follows stiffness", unit="", symbol="b", low=-1.0, high=1.0, typical=(0.0, 0.5), step=0.01,
        meaning="g (k/k₀)^b for link and motor. About 0.35 keeps the torque noise behind encoders even.",
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
    terms: Literal["all", "rate", "none"] = choice(
        "all", "terms of a moving stiffness",
        meaning="What the torque map knows of a stiffness that moves. all: every θ_ms term. rate: only that of τ_s'. none: as if k "
        "stood still. Anything but all costs link error while the stiffness changes under load; for comparison.",
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


Controller = Annotated[StateFeedback | SlidingMode | Baseline, Field(discriminator="kind")]
Observer = Annotated[VelocityObserver | PositionObserver | NoObserver, Field(discriminator="kind")]


class Tuning(Part):
    """Everything a tuning changes; swapped whole between two ticks."""

    controller: Controller = StateFeedback()
    observer: Observer = VelocityObserver()
    schedule: Schedule = Schedule()
    stiffness_loop: StiffnessLoop = StiffnessLoop()
    model: ControllerModel = ControllerModel()
