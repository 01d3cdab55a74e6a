"""Every signal of a session, once: name, symbol, unit, label and group.

The telemetry ring, binary frames, CSV headings, recordings and plots all take their columns from `CHANNELS`; the compiled
kernel writes a row in this order.
"""

from typing import NamedTuple


class Channel(NamedTuple):
    """One recorded signal; its place in `CHANNELS` is its column."""

    name: str
    symbol: str
    unit: str
    label: str
    group: str


CHANNELS: tuple[Channel, ...] = (
    Channel("time", "t", "s", "time", "time"),
    Channel("reference", "θ_ref", "rad", "reference", "position"),
    Channel("link_position", "θ_l", "rad", "link", "position"),
    Channel("motor_position", "θ_e", "rad", "motor", "position"),
    Channel("error", "e₁", "rad", "error", "error"),
    Channel("link_velocity", "θ̇_l", "rad/s", "link velocity", "velocity"),
    Channel("motor_velocity", "θ̇_e", "rad/s", "motor velocity", "velocity"),
    Channel("error_velocity", "e₂", "rad/s", "velocity error", "error state"),
    Channel("error_acceleration", "e₃", "rad/s²", "acceleration error", "error state"),
    Channel("error_jerk", "e₄", "rad/s³", "jerk error", "error state"),
    Channel("sliding_variable", "σ", "rad/s³", "sliding variable", "error state"),
    Channel("snap", "ν", "rad/s⁴", "link snap", "error state"),
    Channel("motor_torque_demand", "τ_e*", "N·m", "demanded torque", "torque"),
    Channel("motor_torque", "τ_e", "N·m", "motor torque", "torque"),
    Channel("motor_torque_limit", "τ_max", "N·m", "torque limit", "torque"),
    Channel("spring_torque", "τ_s", "N·m", "spring torque", "torque"),
    Channel("link_disturbance", "τ_l,d", "N·m", "link disturbance", "disturbance"),
    Channel("link_disturbance_estimate", "τ̂_l,d", "N·m", "link estimate", "disturbance"),
    Channel("motor_disturbance", "τ_e,d", "N·m", "motor disturbance", "disturbance"),
    Channel("motor_disturbance_estimate", "τ̂_e,d", "N·m", "motor estimate", "disturbance"),
    Channel("link_disturbance_rate", "τ̂̇_l,d", "N·m/s", "link estimate, rate", "disturbance"),
    Channel("stiffness", "k", "N·m/rad", "stiffness", "stiffness"),
    Channel("stiffness_reference", "k_ref", "N·m/rad", "stiffness reference", "stiffness"),
    Channel("deflection", "δ", "rad", "deflection", "deflection"),
    Channel("stiffness_motor_position", "θ_ms", "rad", "stiffness motor", "stiffness motor"),
    Channel("stiffness_motor_velocity", "θ̇_ms", "rad/s", "stiffness motor velocity", "stiffness motor"),
    Channel("stiffness_motor_torque", "τ_ms", "N·m", "stiffness motor torque", "stiffness motor"),
    Channel("limits", "", "", "active limits (bits)", "state"),
    Channel("tuning_id", "", "", "tuning in force", "state"),
    Channel("stiffness_motor_disturbance", "τ_ms,d", "N·m", "stiffness motor disturbance", "stiffness motor"),
    Channel("link_disturbance_acceleration", "τ̂̈_l,d", "N·m/s²", "link estimate, acceleration", "disturbance"),
    Channel("motor_disturbance_rate", "τ̂̇_e,d", "N·m/s", "motor estimate, rate", "disturbance"),
)

INDEX: dict[str, int] = {channel.name: column for column, channel in enumerate(CHANNELS)}


class Limit(NamedTuple):
    """One bit of the `limits` channel, with the words shown when it is set."""

    bit: int
    name: str
    sentence: str


LIMITS: tuple[Limit, ...] = (
    Limit(1, "motor_peak_torque", "limited by the motor's peak torque"),
    Limit(2, "motor_continuous_torque", "limited by the motor's continuous torque (I²t)"),
    Limit(4, "motor_speed", "limited by the motor's speed"),
    Limit(8, "stiffness_motor_torque", "limited by the stiffness motor's torque"),
    Limit(16, "stiffness_motor_speed", "limited by the stiffness motor's speed"),
    Limit(32, "leaf_torque", "spring torque above the leaf spring's limit"),
    Limit(64, "stiffness_rate", "stiffness change slowed to its permitted rate"),
    Limit(128, "stiffness_end_stop", "stiffness motor at an end stop"),
    Limit(256, "rig_torque", "limited by the rig's torque limit"),
    Limit(512, "rig_torque_rate", "limited by the rig's torque rate"),
    Limit(1024, "rig_speed", "limited by the rig's speed limit"),
    Limit(2048, "rig_position", "limited by the rig's position limits"),
    Limit(4096, "rig_deflection", "limited by the rig's deflection limit"),
    Limit(8192, "rig_stiffness", "limited by the rig's stiffness range"),
    Limit(16384, "blended_in", "torque blended in after arming"),
)
