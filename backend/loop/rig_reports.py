"""How a rig is, as the page shows it ten times a second."""

from backend.loop.conduct import Conduct
from backend.loop.messages import AxisReport, RigReport
from backend.loop.rig_commands import cannot_arm
from backend.loop.rig_states import CLOSED
from backend.rigs.rig import AXES, Axis, BusHealth, RigError

EVERY_S = 0.1


def rig_report(conduct: Conduct, now: float, missed_cycles: int, lease_left_s: float) -> RigReport:
    """Return the report of a connected rig at the loop's time `now` [s]."""
    on = conduct.on
    try:
        health = on.rig.health()
    except RigError:
        health = BusHealth()
    return RigReport(
        kind=on.identity.kind,
        homed=on.homed,
        span_found=on.span_found,
        motion=words(conduct),
        cannot_arm=cannot_arm(conduct),
        axes=tuple(_axis_report(conduct, axis) for axis in AXES),
        link_age=on.measured.link_age,
        faults=conduct.latch.reports(now),
        cycles=health.cycles,
        late_answers=health.late_answers,
        missed_cycles=missed_cycles,
        round_trip_us=health.round_trip_us,
        lease_left_s=lease_left_s,
        identity=on.identity,
    )


def words(conduct: Conduct) -> str:
    """Return what the rig does, in words."""
    axes = conduct.on.axes
    if conduct.homing is not None:
        return conduct.homing.words
    if conduct.state in CLOSED or conduct.rest_until is not None:
        return conduct.motion.words
    if conduct.arming is not None:
        return "drives coming into operation"
    if conduct.stopping is not None and conduct.stopping.holding:
        return "braking" if axes.on("motor") else "the stiffness axis holds"
    return "stopping" if axes.any_on else "drives off"


def _axis_report(conduct: Conduct, axis: Axis) -> AxisReport:
    status, m = conduct.on.axes.status[axis], conduct.on.measured
    motor = axis == "motor"
    return AxisReport(
        axis=axis,
        state=status.state,
        words=status.words,
        status_word=status.status_word,
        error_code=status.error_code,
        error_words=status.error_words,
        age=m.motor_age if motor else m.stiffness_age,
        torque=m.motor_torque if motor else m.stiffness_torque,
        torque_seen=m.motor_torque_seen if motor else m.stiffness_torque_seen,
    )
