"""A rig's file: which actuator of the library it is, and only what the library does not know: wiring, counts, signs, limits.

TOML, read whole and checked before anything is opened; docs/rig-file.md lists every field, `vssea rig example` writes one.
"""

from typing import Literal, Self

from pydantic import Field, JsonValue, model_validator

from vssea_core.fields import Part

Sign = Literal[1, -1]
SIMULATED = "simulated"
"""The interface of a rig without a bus: the control process simulates it."""
SafetyObject = Literal[0x1016, 0x6007, 0x605A, 0x605E, 0x6072]
"""Watch on this computer, reactions to lost connection, quick stop and fault, and the drive's own torque limit."""


class Bus(Part):
    """How the CAN bus is opened: the arguments of python-can's Bus, such as interface, channel, bitrate, host, port."""

    interface: str = Field(
        description="socketcan, socketcand, slcan, pcan, kvaser ... as python-can names them; simulated: no bus."
    )
    channel: str = Field("can0", description="Name of the channel at that interface.")
    bitrate: int | None = Field(1_000_000, description="Bits a second, where the interface sets them; null = as it is.")
    options: dict[str, JsonValue] = Field(default_factory=dict, description="Further arguments, such as host and port.")


class Drive(Part):
    """A CiA 402 drive in cyclic synchronous torque mode, and its encoder."""

    node: int = Field(ge=1, le=126, description="CANopen node number; 127 is this computer's own.")
    device_type: int = Field(0x00020192, description="What object 0x1000 must say; servo drive, CiA 402.")
    vendor: int | None = Field(None, description="What object 0x1018:1 must say; null = any.")
    serial: int | None = Field(None, description="What object 0x1018:4 must say; null = any.")
    counts_per_turn: int = Field(ge=4, description="Position counts (0x6064) in a turn of this motor, four a line.")
    sign: Sign = Field(1, description="1 if positive counts and torque are positive in the model.")
    rated_torque_unit: float = Field(
        1e-6, gt=0.0, description="N·m in a unit of object 0x6076 (µN·m on EPOS4, mN·m by CiA 402)."
    )
    efficiency: float = Field(
        1.0, gt=0.05, le=1.0, description="Torque at the gear side = efficiency x ratio x motor torque."
    )
    torque_limit: float = Field(gt=0.0, description="Most that is ever asked [N·m], gear side for the motor.")
    torque_constant: float | None = Field(
        None, gt=0.0, description="N·m/A of this motor, only to show currents; null = torques only."
    )
    quick_stop_deceleration: int | None = Field(
        None, ge=1, description="Object 0x6085 in the drive's unit; null = as it is."
    )
    without: tuple[SafetyObject, ...] = Field(
        (), description="Safety objects that this drive lacks and that you accept to be missing."
    )


class LinkEncoder(Part):
    """The encoder at the output: a CiA 406 node of its own, or the second encoder of a drive."""

    source: Literal["node", "motor_drive", "stiffness_drive"] = Field(
        "node", description="A node of its own, or the drive whose second encoder it is."
    )
    node: int | None = Field(
        None, ge=1, le=126, description="CANopen node number, where source is node; 127 is this computer's own."
    )
    index: int = Field(0x6004, description="Object with the position: 0x6004 of CiA 406, the vendor's own on a drive.")
    subindex: int = Field(0, ge=0, le=255, description="Its subindex.")
    bits: Literal[8, 16, 32] = Field(32, description="Length of that object in the PDO.")
    counts_per_turn: int = Field(ge=4, description="Counts in a turn of the link.")
    sign: Sign = Field(1, description="1 if positive counts are positive in the model.")
    zero: int = Field(0, description="Counts where the link's position is 0 rad.")

    @model_validator(mode="after")
    def _node_given(self) -> Self:
        if (self.source == "node") != (self.node is not None):
            raise ValueError("link.node is needed where link.source is 'node', and only there")
        return self


class Limits(Part):
    """What the rig stands. Applied last, whatever the tuning asks; a tuning can only be narrower."""

    motor_torque: float = Field(gt=0.0, description="N·m, gear side.")
    motor_torque_rate: float = Field(gt=0.0, description="N·m/s.")
    motor_speed: float = Field(gt=0.0, description="rad/s, gear side; 1.25 times it is a fault.")
    link_speed: float = Field(
        3.0, gt=0.0, description="rad/s of the link while the loops are closed; faster is a fault."
    )
    stiffness_torque: float = Field(gt=0.0, description="N·m of the stiffness motor.")
    stiffness_speed: float = Field(gt=0.0, description="rad/s of the stiffness motor.")
    link_low: float = Field(description="rad.")
    link_high: float = Field(description="rad.")
    braking: float = Field(10.0, gt=0.0, description="rad/s²: deceleration the position limits count on.")
    deflection: float = Field(gt=0.0, description="rad; 1.25 times it is a fault.")
    stiffness_low: float = Field(gt=0.0, description="N·m/rad, inside the end stop.")
    stiffness_high: float = Field(gt=0.0, description="N·m/rad, inside the end stop.")
    following_error: float = Field(0.2, gt=0.0, description="rad between reference and link for 0.2 s is a fault.")
    jog_speed: float = Field(0.5, gt=0.0, description="rad/s, the fastest jog of the link.")
    stiffness_jog: float = Field(200.0, gt=0.0, description="N·m/rad a second, the fastest jog of the stiffness.")

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.link_low >= self.link_high:
            raise ValueError(f"limits.link_low {self.link_low:g} rad is not below link_high {self.link_high:g} rad")
        if self.stiffness_low >= self.stiffness_high:
            raise ValueError(
                f"limits.stiffness_low {self.stiffness_low:g} N·m/rad is not below stiffness_high {self.stiffness_high:g}"
            )
        return self


class Homing(Part):
    """How the stiffness axis finds itself: slowly to the stiff stop, then to the soft one; their distance is checked."""

    torque: float = Field(0.10, gt=0.0, description="N·m of the stiffness motor while it looks for a stop.")
    speed: float = Field(15.0, gt=0.0, description="rad/s while it looks for a stop.")
    span_tolerance: float = Field(
        0.02, gt=0.0, le=0.5, description="Share by which the distance of the stops may differ."
    )
    still_s: float = Field(0.15, gt=0.0, description="s without motion that make a stop.")
    time_limit_s: float = Field(30.0, gt=0.0, description="s after which homing fails.")
    align_motor: bool = Field(
        True,
        description="Take the motor to be where the link is, at the stiff stop; false only for an absolute motor encoder.",
    )


class RigFile(Part):
    """One rig."""

    name: str = Field(
        min_length=1, max_length=60, pattern=r"^[\w .+-]+$", description="Of letters, digits, blanks and . + - _."
    )
    note: str = Field("", max_length=500, description="Shown beside the name.")
    actuator: str | None = Field(None, description="Name in the actuator library; null = the default actuator.")
    preset: str | None = Field(None, description="Preset to begin with; null = the tuning in force, if it fits.")
    rate_hz: Literal[200, 250, 500, 1000] = Field(
        500, description="Cycles a second: 200, 250, 500 or 1000; 500 on CAN, 250 on a USB serial adapter."
    )
    answer_share: float = Field(
        0.6, gt=0.1, lt=0.95, description="Share of a cycle in which the answers must be there."
    )
    bus: Bus = Field(description="How the CAN bus is opened.")
    motor: Drive = Field(description="The drive of the equilibrium motor.")
    stiffness: Drive = Field(description="The drive of the stiffness motor.")
    link: LinkEncoder = Field(description="The encoder at the output.")
    limits: Limits = Field(description="What the rig stands.")
    homing: Homing = Field(Homing(), description="How the stiffness axis finds itself.")

    @model_validator(mode="after")
    def _nodes_differ(self) -> Self:
        nodes = [self.motor.node, self.stiffness.node, *([self.link.node] if self.link.node else [])]
        if len(set(nodes)) < len(nodes):
            raise ValueError(f"nodes {', '.join(map(str, nodes))} are not all different; give each its own number")
        return self
