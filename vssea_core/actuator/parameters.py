"""Parameters of the actuator, its sensors and the timing of its control computer (theory: section 1).

All quantities of the equilibrium motor are at the gear side: J_e = N^2 J_me + J_g, tau_e = N tau_me (Eqs. 1, 5).
"""

from typing import Literal, Self

from pydantic import model_validator

from vssea_core.fields import Part, choice, parameter


class Link(Part):
    """The output link: J_l theta_l'' + b_l theta_l' = tau_s - tau_l_dist, Eq. (1)."""

    inertia: float = parameter(
        0.10, "link inertia", unit="kg·m²", symbol="J_l", low=0.005, high=5.0, typical=(0.03, 0.45), step=0.001,
        scale="log", equation="(1)", basis="E", meaning="Inertia of the output link and what is fixed to it.",
    )
    damping: float = parameter(
        0.10, "link damping", unit="N·m·s/rad", symbol="b_l", low=0.0, high=20.0, typical=(0.005, 1.0), step=0.005,
        equation="(1)", basis="E", meaning="Viscous friction of the output bearing.",
    )


class EquilibriumMotor(Part):
    """Motor and gear that move the spring's equilibrium: J_e theta_e'' + b_e theta_e' = tau_e - tau_s - tau_e_dist, Eq. (1)."""

    gear_ratio: float = parameter(
        100.0, "gear ratio", unit="", symbol="N", low=1.0, high=1000.0, step=1.0, basis="P",
        meaning="Reduction from motor to gear side; here it only scales the motor encoder.",
    )
    inertia: float = parameter(
        3.17, "motor inertia", unit="kg·m²", symbol="J_e", low=0.01, high=100.0, typical=(3.1, 3.6), step=0.01,
        equation="(1)", basis="D", meaning="Rotor and gear inertia at the gear side, N² J_me + J_g.",
    )
    damping: float = parameter(
        4.0, "motor damping", unit="N·m·s/rad", symbol="b_e", low=0.0, high=200.0, typical=(2.0, 18.0), step=0.1,
        equation="(1)", basis="E", meaning="Viscous friction of motor and gear at the gear side.",
    )
    coulomb_friction: float = parameter(
        0.0, "Coulomb friction", unit="N·m", symbol="τ_c", low=0.0, high=50.0, typical=(0.0, 9.0), step=0.1,
        basis="E", meaning="Dry friction at the gear side, smoothed as v/√(v²+ε²); 2 to 9 N·m is usual for such a gear.",
    )
    friction_velocity: float = parameter(
        0.005, "friction smoothing", unit="rad/s", symbol="ε", low=5e-4, high=1.0, step=5e-4, scale="log",
        meaning="Speed below which the dry friction falls smoothly to zero.",
    )
    peak_torque: float = parameter(
        74.0, "peak torque", unit="N·m", symbol="τ_max", low=0.1, high=1e4, typical=(50.0, 106.0), step=1.0,
        basis="D", meaning="Largest torque of the drive at the gear side.",
    )
    continuous_torque: float = parameter(
        25.0, "continuous torque", unit="N·m", symbol="τ_cont", low=0.05, high=1e4, typical=(10.0, 74.0), step=1.0,
        basis="D", meaning="RMS torque that the winding stands for ever; equal to the peak torque switches I²t off.",
    )
    thermal_time_s: float = parameter(
        20.0, "thermal time", unit="s", symbol="τ_th", low=0.1, high=1000.0, step=1.0, basis="E",
        meaning="Time constant over which the squared torque is averaged for I²t.",
    )
    no_load_speed: float = parameter(
        3.34, "no-load speed", unit="rad/s", symbol="ω₀", low=0.01, high=1000.0, step=0.01, basis="D",
        meaning="Speed at which no driving torque is left: |ω| ≤ ω₀ (1 - |τ|/τ_stall).",
    )
    stall_torque: float = parameter(
        327.0, "stall torque", unit="N·m", symbol="τ_stall", low=0.1, high=1e5, step=1.0, basis="D",
        meaning="Torque of the winding at standstill, without the drive's limit; sets the slope of the speed limit.",
    )
    torque_lag_s: float = parameter(
        0.0, "torque-loop lag", unit="s", symbol="T_lag", low=0.0, high=5e-3, typical=(0.0, 5e-4), step=1e-5, basis="E",
        meaning="First-order lag of the drive's current loop; 0.1 to 0.5 ms is usual.",
    )
    torque_delay_s: float = parameter(
        0.0, "torque delay", unit="s", symbol="T_d", low=0.0, high=0.02, typical=(0.0, 5e-3), step=1e-4, basis="E",
        meaning="Transport delay of the drive, any fraction of a sample; the controller does not know of it.",
    )

    @model_validator(mode="after")
    def _continuous_within_peak(self) -> Self:
        if self.continuous_torque > self.peak_torque:
            raise ValueError(
                f"continuous torque {self.continuous_torque:g} N·m is above the peak torque {self.peak_torque:g} N·m; "
                "expected at most the peak torque"
            )
        return self


class StiffnessMechanism(Part):
    """Leaf spring and the motor that changes it: Eqs. (2)-(4), k = (Y_tau / (2 theta_ms^3)) cos(delta / 2)."""

    spring_constant: float = parameter(
        6.2e7, "spring constant", unit="N·m·rad³", symbol="Y_τ", low=1e4, high=1e10, step=1e5, scale="log",
        equation="(3)", basis="E", meaning="Torque constant of the leaf spring; 5 mm/rev screw, leaf 25 to 92 mm.",
    )
    inertia: float = parameter(
        1.0e-4, "stiffness motor inertia", unit="kg·m²", symbol="J_ms", low=1e-6, high=1.0, typical=(0.83e-4, 1.3e-4),
        step=1e-6, scale="log", equation="(2)", basis="D", meaning="Inertia of the stiffness motor and its screw.",
    )
    damping: float = parameter(
        1.0e-4, "stiffness motor damping", unit="N·m·s/rad", symbol="b_ms", low=0.0, high=1.0, step=1e-5,
        equation="(2)", basis="E", meaning="Viscous friction of the stiffness motor.",
    )
    softest: float = parameter(
        20.0, "softest stiffness", unit="N·m/rad", symbol="k_min", low=1.0, high=1e5, step=1.0, basis="P",
        meaning="Stiffness at the soft end stop.",
    )
    stiffest: float = parameter(
        1000.0, "stiffest", unit="N·m/rad", symbol="k_max", low=1.0, high=1e5, step=1.0, basis="P",
        meaning="Stiffness at the stiff end stop.",
    )
    peak_torque: float = parameter(
        0.79, "stiffness motor peak torque", unit="N·m", symbol="τ_ms,max", low=0.01, high=100.0, step=0.01, basis="D",
        meaning="Largest torque of the stiffness drive.",
    )
    continuous_torque: float = parameter(
        0.30, "stiffness motor continuous torque", unit="N·m", symbol="τ_ms,cont", low=0.005, high=100.0, step=0.01,
        basis="D", meaning="RMS torque of the stiffness motor.",
    )
    speed_limit: float = parameter(
        430.0, "stiffness motor speed limit", unit="rad/s", symbol="ω_ms,max", low=1.0, high=5000.0, step=1.0,
        basis="D", meaning="Speed above which the stiffness drive gives no driving torque.",
    )
    leaf_torque: float = parameter(
        35.0, "leaf torque limit", unit="N·m", symbol="τ_s,max", low=0.1, high=1e4, step=1.0, basis="E",
        meaning="Spring torque the leaf stands at 1000 N·m/rad; at k it is this times (k/1000)^(1/3). Reported, not enforced.",
    )
    back_torque: Literal["energy", "paper"] = choice(
        "energy", "torque on the stiffness motor", equation="(2)",
        meaning="energy: the gradient of the spring's energy. paper: Eq. (2) as printed, the spring torque itself, "
        "which throws the stiffness motor into its stop within 10 ms.",
    )

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.softest >= self.stiffest:
            raise ValueError(f"softest {self.softest:g} N·m/rad is not below stiffest {self.stiffest:g} N·m/rad")
        if self.continuous_torque > self.peak_torque:
            raise ValueError(
                f"stiffness motor continuous torque {self.continuous_torque:g} N·m is above "
                f"its peak torque {self.peak_torque:g} N·m"
            )
        return self


class Actuator(Part):
    """The plant as it truly is; what the controller believes is `Tuning.model`."""

    link: Link = Link()
    motor: EquilibriumMotor = EquilibriumMotor()
    stiffness: StiffnessMechanism = StiffnessMechanism()


def _noise(title: str, symbol: str, unit: str, high: float, usual: float, meaning: str) -> float:
    field: float = parameter(
        0.0, title, unit=unit, symbol=symbol, low=0.0, high=high, typical=(0.0, usual), step=usual / 100.0, basis="E",
        meaning=f"Root mean square of the seeded Gaussian noise. {meaning}",
    )
    return field


class Sensors(Part):
    """What is measured. A resolution of 0 means an ideal sensor."""

    link_bits: int = parameter(
        0, "link encoder", unit="bit", low=0, high=32, typical=(14, 20), step=1, basis="E",
        meaning="Bits per turn of the link encoder; 0 = ideal.",
    )
    motor_counts: int = parameter(
        0, "motor encoder", unit="counts/rev", low=0, high=10_000_000, typical=(1000, 65536), step=1, basis="D",
        meaning="Counts per turn of the motor, before the gear; 0 = ideal.",
    )
    stiffness_counts: int = parameter(
        0, "stiffness motor encoder", unit="counts/rev", low=0, high=10_000_000, typical=(1000, 65536), step=1,
        basis="E", meaning="Counts per turn of the stiffness motor; 0 = ideal.",
    )
    velocities: bool = choice(True, "velocities measured", meaning="Whether ideal velocity signals exist, as the paper assumes.")
    link_noise: float = _noise("link encoder noise", "σ_l", "rad", 0.1, 1e-4, "Added before rounding to counts; 0 = none.")
    motor_noise: float = _noise(
        "motor encoder noise", "σ_e", "rad", 0.1, 1e-5, "At the gear side, added before rounding to counts; 0 = none."
    )
    stiffness_noise: float = _noise(
        "stiffness encoder noise", "σ_ms", "rad", 1.0, 1e-2, "Added before rounding to counts; 0 = none."
    )
    velocity_noise: float = _noise(
        "velocity noise", "σ_ω", "rad/s", 10.0, 1e-1, "Of each of the three velocity signals; 0 = none."
    )


class Timing(Part):
    """Sample time and compute delay of the control computer."""

    sample_time_s: float = parameter(
        1e-3, "sample time", unit="s", symbol="T", low=1e-4, high=5e-3, step=1e-4, basis="P",
        meaning="Period of the control tick.",
    )
    compute_delay_samples: Literal[0, 1] = choice(
        0, "compute delay", meaning="Samples between a measurement and the torque that answers it."
    )
