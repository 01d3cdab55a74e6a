"""The fault catalogue: every number once, with its cause in a sentence and what to do. docs/faults.md lists the same.

Faults below 100 latch and take torque off; 100 and above are stops without a fault: nothing is wrong with the rig.
"""

from typing import NamedTuple


class Fault(NamedTuple):
    """One numbered cause."""

    number: int
    name: str
    cause: str
    remedy: str

    def sentence(self, detail: str = "") -> str:
        """Return cause, detail and remedy in words."""
        return f"{self.cause}{f' ({detail})' if detail else ''}. {self.remedy}"


BUS_SILENT = Fault(
    1, "bus_silent", "No node has answered for 10 cycles", "Check power, cable and termination, then connect again."
)
MOTOR_SILENT = Fault(
    2, "motor_drive_silent", "The motor drive has been silent for 10 cycles", "Check its power and cable, then Reset."
)
STIFFNESS_SILENT = Fault(
    3,
    "stiffness_drive_silent",
    "The stiffness drive has been silent for 10 cycles",
    "Check its power and cable, then Reset.",
)
LINK_SILENT = Fault(
    4, "link_encoder_silent", "The link encoder has been silent for 10 cycles", "Check the cable, then Reset."
)
MOTOR_DRIVE = Fault(5, "motor_drive_fault", "The motor drive reports a fault", "Clear its cause, then Reset.")
STIFFNESS_DRIVE = Fault(
    6, "stiffness_drive_fault", "The stiffness drive reports a fault", "Clear its cause, then Reset."
)
LINK_ENCODER = Fault(7, "link_encoder_fault", "The link encoder reports a fault", "Clear its cause, then Reset.")
LINK_JUMP = Fault(
    8,
    "link_encoder_jump",
    "The link encoder jumped farther than the link can move",
    "Check encoder, coupling and cable, then Reset.",
)
MOTOR_JUMP = Fault(
    9,
    "motor_encoder_jump",
    "The motor encoder jumped farther than the motor can move",
    "Check encoder and cable, then Reset.",
)
STIFFNESS_JUMP = Fault(
    10,
    "stiffness_encoder_jump",
    "The stiffness encoder jumped farther than its motor can move",
    "Check encoder and cable, then home again.",
)
LINK_FROZEN = Fault(
    11, "link_encoder_frozen", "The link encoder stood still to the count while the motor moved",
    "Check whether the encoder is frozen or the link is blocked, then Reset.",
)  # fmt: skip
NOT_A_NUMBER = Fault(
    12, "not_a_number", "The controller computed something that is no number", "Change the tuning, then Reset."
)
OVERSPEED = Fault(13, "overspeed", "The motor was faster than its limit", "Find out what drove it, then Reset.")
OUTSIDE = Fault(
    14, "outside_limits", "A position left the rig's limits", "Move it back by hand with the drives off, then Reset."
)
DEFLECTION = Fault(15, "deflection", "The spring was deflected beyond its limit", "Take the load off, then Reset.")
LEAF_TORQUE = Fault(
    16,
    "leaf_torque",
    "The spring torque was above what the leaf stands at this stiffness",
    "Take the load off, then Reset.",
)
END_STOP = Fault(17, "stiffness_end_stop", "The stiffness motor ran into an end stop", "Home it again.")
FOLLOWING = Fault(
    18,
    "following_error",
    "The link was farther from its reference than allowed",
    "Change tuning or reference, then Reset.",
)
LEFT_ENABLED = Fault(
    19, "drive_left_operation", "A drive left operation by itself", "Look at its status words, then Reset."
)
HOT = Fault(20, "over_temperature", "A drive reports over-temperature", "Let it cool, then Reset.")
REBOOTED = Fault(
    21, "node_rebooted", "A node has restarted and lost its configuration", "Disconnect and connect again."
)
BUS_OFF = Fault(
    22,
    "bus_off",
    "The CAN interface reports bus-off or error frames",
    "Check wiring and termination, then connect again.",
)
TORQUE_NOT_GIVEN = Fault(
    23,
    "torque_not_given",
    "A drive has not given the torque that was asked of it",
    "Check its own current limit and supply, then Reset.",
)
LOOP_LATE = Fault(
    24, "loop_late", "The control loop missed 10 cycles in a row", "Take load off this computer, then Reset."
)
HOMING = Fault(
    25,
    "homing_failed",
    "Homing did not find two end stops where they should be",
    "Look at the mechanism, then home again.",
)
WRONG_DEVICE = Fault(
    26, "wrong_device", "A node is not the device that the rig's file names", "Correct wiring, node number or file."
)
CONFIGURATION = Fault(
    27,
    "configuration_refused",
    "A drive did not take over its configuration",
    "Correct the rig's file or the drive's settings.",
)
NO_BUS = Fault(
    28,
    "no_bus",
    "The CAN bus cannot be opened",
    "Start the adapter, or the emulator with `vssea emulator`, and connect again.",
)
ENABLE_TIMEOUT = Fault(
    29, "enable_timeout", "A drive did not come into operation in time", "Look at its status words, then Reset."
)
CORRUPTED = Fault(
    30,
    "frames_corrupted",
    "Frames came with a wrong length or impossible content",
    "Check cable, termination and PDO mapping, then Reset.",
)
DISTURBANCE = Fault(
    31, "model_mismatch", "The observer blames the rig for more torque than the motor has",
    "The model (inertia, signs, stiffness) does not fit the rig: correct it, then Reset.",
)  # fmt: skip

MOTOR_FROZEN = Fault(
    32,
    "motor_encoder_frozen",
    "The motor encoder stood still to the count while the link moved",
    "Check whether the encoder is frozen or the motor is blocked, then Reset.",
)
STIFFNESS_ASTRAY = Fault(
    33,
    "stiffness_motor_astray",
    "The stiffness motor does not move as its torque says",
    "Check its encoder, its screw and the model, then home it again.",
)
LINK_OVERSPEED = Fault(
    34, "link_overspeed", "The link was faster than its limit", "Change tuning or reference, then Reset."
)

STOP_REQUESTED = Fault(100, "stop_requested", "Stopped on request", "Reset to go on.")
LEASE_EXPIRED = Fault(101, "lease_expired", "The operator's page has been silent", "Take control and Reset to go on.")
WEB_SILENT = Fault(102, "web_silent", "The server has been silent for 250 ms", "Reset to go on.")
PROCESS_ENDED = Fault(103, "process_ended", "The control process was told to end", "Connect again.")

FAULTS: tuple[Fault, ...] = tuple(value for value in list(globals().values()) if isinstance(value, Fault))
"""All of them, by number."""
