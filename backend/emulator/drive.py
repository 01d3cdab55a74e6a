"""An emulated CiA 402 drive in cyclic synchronous torque mode: state machine, ramps, reactions to errors and lost hosts."""

import math

from backend.emulator.cia402 import (
    FOLLOWS,
    HALT,
    LIMITED,
    POWERED,
    REMOTE,
    STATUS_BITS,
    STAYS,
    TARGET_REACHED,
    VOLTAGE,
    State,
    controlled,
)
from backend.emulator.drive_objects import COUNTS_PER_TURN, CYCLIC_TORQUE, drive_objects
from backend.emulator.encoder import Encoder
from backend.emulator.network import EmulatedNetwork
from backend.emulator.node import COMMUNICATION_ERROR, EXCHANGE_ENDED, EmulatedNode
from backend.emulator.plant import AXES, MOTOR, EmulatedPlant

EFFICIENCY = 0.7  # of the gear
TORQUE_CONSTANT = (0.0705, 0.0534)  # N m/A of both motors, for their rated currents
DECELERATION = (15.0, 5000.0)  # rad/s^2 of a quick stop, at the gear side
STANDSTILL = (0.02, 2.0)  # rad/s below which an axis stands still
RAMP_LOOK_S = 0.002  # how often the end of a ramp is looked for
PATIENCE_S = 1.0  # an axis that cannot be stopped is let go this long after its ramp
_LEAST, _MOST = -(1 << 31), (1 << 31) - 1


class EmulatedDrive(EmulatedNode):
    """The drive of one axis of the plant. Its dictionary counts at the motor: torque per thousand of rated, counts."""

    def __init__(
        self, number: int, axis: int, plant: EmulatedPlant, network: EmulatedNetwork, shown_at_start: float = 0.0
    ) -> None:
        self.axis, self.plant = axis, plant
        motor, mechanism = plant.actuator.motor, plant.actuator.stiffness
        ratio = motor.gear_ratio if axis == MOTOR else 1.0
        self.gain = ratio * EFFICIENCY if axis == MOTOR else 1.0  # N m at the gear side per N m of the motor
        rated = motor.continuous_torque / self.gain if axis == MOTOR else mechanism.continuous_torque
        rated_torque = round(1e6 * rated)
        self.unit = 1e-9 * rated_torque * self.gain  # N m at the gear side in a thousandth of rated
        self.peak = motor.peak_torque if axis == MOTOR else mechanism.peak_torque
        self.share = 1.0  # of its peak that it gives
        absolute = axis == MOTOR  # the other counts from where it was switched on
        zero = 0.0 if absolute else plant.position(axis) - shown_at_start
        self.encoder = Encoder(COUNTS_PER_TURN * ratio, zero)
        self.state = State.NOT_READY
        self.cause: tuple[int, int] | None = None  # of a fault: error code and bits of the error register
        self.times_enabled = self.times_left = 0
        self._controlword = 0
        self._after_stop: State | None = None  # where a ramp leads
        self._stop_by = 0.0
        self._halted = False
        counts = round(DECELERATION[axis] * self.encoder.counts_per_rad)
        current = round(1e3 * rated / TORQUE_CONSTANT[axis])
        max_torque = math.floor(self.peak / self.unit)
        objects = drive_objects(number, AXES[axis], rated_torque, current, max_torque, counts, round(ratio))
        super().__init__(number, objects, network)

    # Dictionary ------------------------------------------------------------------------------------------------------

    def switched_on(self) -> None:
        """Begin switched off, without a mode."""
        self._controlword, self._after_stop, self._halted = 0, None, False
        self._go(State.DISABLED)
        if self.cause is not None:
            self.fail(*self.cause)

    def powered_off(self) -> None:
        """Let go of the motor, and of the place where it was, unless the encoder is absolute."""
        self._go(State.NOT_READY)
        if self.axis != MOTOR:
            self.encoder.zero = self.plant.position(self.axis)

    def latch(self) -> None:
        """Put what is measured now into the dictionary."""
        plant, axis, values = self.plant, self.axis, self.values
        per_mille = round(plant.given(axis) / self.unit)
        values[0x6064, 0] = self.encoder.counts(plant.position(axis))
        velocity = plant.velocity(axis) * self.encoder.counts_per_rad
        values[0x606C, 0] = round(min(_MOST, max(_LEAST, velocity)))
        values[0x6077, 0] = values[0x6078, 0] = min(32767, max(-32768, per_mille))
        values[0x6041, 0] = self.statusword()

    def statusword(self) -> int:
        """Return the statusword."""
        word = STATUS_BITS[self.state] | VOLTAGE | REMOTE
        if self.plant.is_limited(self.axis) and self.state is State.ENABLED:
            word |= LIMITED
        if self._follows():
            word |= FOLLOWS
        elif self.state in (State.QUICK_STOP, State.ENABLED) and self._stands():
            word |= TARGET_REACHED
        return word

    def wrote(self, index: int, sub: int, value: int) -> None:
        """Act on a new value."""
        if index == 0x6040:
            self._control(value)
        elif index in (0x6071, 0x60B2, 0x6072, 0x6060):
            self.values[0x6061, 0] = self.values[0x6060, 0]
            self._drive()

    def _follows(self) -> bool:
        enabled = self.state is State.ENABLED and self.values[0x6060, 0] == CYCLIC_TORQUE
        return enabled and self._after_stop is None and not self._halted

    # State machine ---------------------------------------------------------------------------------------------------

    def _control(self, controlword: int) -> None:
        previous, self._controlword = self._controlword, controlword
        after, resets = controlled(self.state, controlword, previous, self.values[0x605A, 0], self.cause is not None)
        if resets:
            self.values[0x603F, 0] = 0
            self.emergency(0)
        halted, self._halted = self._halted, bool(controlword & HALT) and after is State.ENABLED
        if after is not self.state:
            self._leave_for(after)
        elif self.state is State.ENABLED and (halted != self._halted or self._after_stop is not None):
            self._after_stop = None  # told to go on before it stood still
            self._drive()

    def _leave_for(self, after: State) -> None:
        if self.state is State.ENABLED and after in (State.SWITCHED_ON, State.READY):
            option = self.values[0x605C if after is State.SWITCHED_ON else 0x605B, 0]
            if option == 1:
                if self._after_stop is not after:
                    self._ramp(after, self.values[0x6084, 0])
                return
        if after is State.QUICK_STOP:
            self._quick_stop()
            return
        self._go(after)

    def _quick_stop(self) -> None:
        option = self.values[0x605A, 0]
        if option == 0:
            self._go(State.DISABLED)
            return
        self._go(State.QUICK_STOP)
        ramp = self.values[0x6084 if option in (1, 5) else 0x6085, 0]
        self._ramp(State.QUICK_STOP if option in STAYS else State.DISABLED, ramp)

    def fail(self, code: int, register: int) -> None:
        """Have an error: emergency, reaction by option code 0x605E, then the state fault."""
        if self.is_restarting:
            return
        self.values[0x603F, 0] = code
        self.emergency(code, register)
        self._react()

    def _react(self) -> None:
        if self.state in (State.REACTION, State.FAULT):
            return
        option, powered = self.values[0x605E, 0], self.state in (State.ENABLED, State.QUICK_STOP)
        if option == 0 or not powered:
            self._go(State.FAULT)
            return
        self._go(State.REACTION)
        self._ramp(State.FAULT, self.values[0x6084 if option == 1 else 0x6085, 0])

    def connection_lost(self, code: int) -> None:
        """React by the abort connection option code 0x6007 if there is power on the motor."""
        option = self.values[0x6007, 0]
        if self.state not in POWERED or option == 0:
            return
        if option == 1:
            if code == EXCHANGE_ENDED:  # the others have been told
                self.emergency(code, COMMUNICATION_ERROR)
            self.values[0x603F, 0] = code
            self._react()
        elif option == 2 or self.state is State.SWITCHED_ON:
            self._go(State.DISABLED)
        elif self.state is State.ENABLED:
            self._quick_stop()

    def recovered(self) -> None:
        """Note that the host is heard again; a fault stays an error."""
        if self.state not in (State.REACTION, State.FAULT):
            super().recovered()

    def deadline(self) -> float:
        """Return when `turn` has to be called, soon while a ramp leads somewhere."""
        return min(super().deadline(), self.now + RAMP_LOOK_S if self._is_leaving() else math.inf)

    def _is_leaving(self) -> bool:
        return self._after_stop not in (None, self.state)

    def watch_time(self) -> None:
        """Go where a ramp leads once the axis stands still, or after all patience."""
        if self._is_leaving() and (self._stands() or self.now >= self._stop_by):
            self._go(self._after_stop or self.state)

    def _stands(self) -> bool:
        plant, axis = self.plant, self.axis
        return plant.is_down(axis) and abs(plant.velocity(axis)) < STANDSTILL[axis]

    def _go(self, state: State) -> None:
        if self.state is State.ENABLED and state is not State.ENABLED:
            self.times_left += 1
        if state is State.ENABLED and self.state is not State.ENABLED:
            self.times_enabled += 1
        self.state, self._after_stop = state, None
        self._drive()

    # Torque ----------------------------------------------------------------------------------------------------------

    def _ramp(self, after: State, deceleration: int) -> None:
        slope = max(1, deceleration) / self.encoder.counts_per_rad
        self.plant.brake(self.axis, slope)
        self._after_stop = after
        self._stop_by = self.now + abs(self.plant.velocity(self.axis)) / slope + PATIENCE_S

    def limit(self) -> None:
        """Take over how much torque the drive gives at most."""
        self.plant.cap(self.axis, self.share * min(self.peak, self.values[0x6072, 0] * self.unit))

    def _drive(self) -> None:
        """Give the axis what state, mode and target ask for."""
        self.limit()
        if self._follows():
            most = self.values[0x6072, 0]
            target = min(most, max(-most, self.values[0x6071, 0] + self.values[0x60B2, 0]))
            self.values[0x6074, 0] = target
            self.plant.give(self.axis, target * self.unit)
        elif self.state is State.ENABLED and self._halted:
            slow = 0x6084 if self.values[0x605D, 0] == 1 else 0x6085
            self.plant.brake(self.axis, max(1, self.values[slow, 0]) / self.encoder.counts_per_rad)
        elif self._after_stop is None and self.state is not State.QUICK_STOP:
            self.values[0x6074, 0] = 0
            self.plant.off(self.axis)
