"""What each command does to a connected rig, or the sentence that refuses it."""

from backend.loop import messages
from backend.loop.arming import ENABLE_S, Situation, reasons
from backend.loop.conduct import Conduct
from backend.loop.freshness import STOPS, oldest
from backend.loop.messages import Command
from backend.rigs.rig import AXES

REST_S = 3.0
"""Time [s] in which a rig that is disarmed has to come to rest."""
RESET_S = 1.5
"""Time [s] in which a drive has to leave its fault."""


def apply(conduct: Conduct, number: int, command: Command) -> bool:
    """Apply a command that its state allows; return whether it is answered at once. Raises ValueError with a refusal."""
    motion, on, now = conduct.motion, conduct.on, conduct.clock()
    match command:
        case messages.Home():
            _home(conduct)
        case messages.Arm():
            _arm(conduct, number)
            return False
        case messages.Disarm():
            _disarm(conduct)
        case messages.Reset():
            _reset(conduct, number)
            return conduct.resetting is None
        case messages.Follow():
            motion.follow()
        case messages.Hold():
            motion.hold()
        case messages.Jog(link, stiffness, sent_s):
            motion.jog(link, stiffness, sent_s, now)
        case messages.GoTo(position, speed):
            motion.go_to(position, speed)
        case messages.SetReference(reference):
            motion.set_reference(reference)
        case messages.SetStiffness(stiffness_reference):
            motion.set_stiffness(stiffness_reference)
        case messages.SetDisturbances(disturbances):
            on.controller.set_disturbances(disturbances)
        case messages.Install(tuning, prepared, tuning_id):
            on.install(tuning, prepared, tuning_id)
    conduct.match_motion()
    return True


def cannot_arm(conduct: Conduct) -> tuple[str, ...]:
    """Return why arming would be refused now."""
    on, controller = conduct.on, conduct.on.controller
    speeds = controller.link_velocity, conduct.monitors.motor_speed, controller.stiffness_velocity
    situation = Situation(
        on.measured,
        on.homed,
        speeds if on.homed else (0.0, conduct.monitors.motor_speed, 0.0),
        (on.last_stage.theta_ms_stiff, on.last_stage.theta_ms_soft),
        on.tuning_period_s,
        on.period_s,
        conduct.watchdogs.lease_left_s,
    )
    return reasons(situation, on.limits, on.axes, conduct.latch)


def _home(conduct: Conduct) -> None:
    on = conduct.on
    reason = _cannot_home(conduct)
    if reason:
        raise ValueError(reason)
    conduct.homing, conduct.stopping = on.begin_homing(), None
    conduct.monitors.restart()
    conduct.enable_until = conduct.clock() + ENABLE_S
    on.axes.arm("stiffness")
    conduct.become("homing", None)


def _cannot_home(conduct: Conduct) -> str | None:
    status = conduct.on.axes.status["stiffness"]
    if oldest(conduct.on.measured) >= STOPS:
        return "measurements are missing; check the bus"
    if conduct.watchdogs.lease_left_s <= 0.0:
        return "nobody is in control; take control"
    if conduct.arming is not None:
        return "the rig is being armed; wait"
    if conduct.stopping is not None and conduct.stopping.holding:
        return "the stiffness axis holds a loaded spring; take the load off first"
    if status.state not in ("disabled", "stopping"):  # a drive that was left holding by its quick stop is taken over
        return f"the stiffness drive is not ready ({status.words}); look at its status"
    return None


def _arm(conduct: Conduct, number: int) -> None:
    found = cannot_arm(conduct)
    if found:
        raise ValueError("; ".join(found))
    if conduct.arming is not None:
        raise ValueError("the rig is being armed already")
    conduct.arming = (number, conduct.clock() + ENABLE_S)
    for axis in AXES:
        conduct.on.axes.arm(axis)


def _disarm(conduct: Conduct) -> None:
    conduct.motion.hold("disarm")
    conduct.goal, conduct.rest_until = "ready", conduct.clock() + REST_S
    conduct.become("stopping", None)


def _reset(conduct: Conduct, number: int) -> None:
    """Take back stop and faults; a drive at fault is asked once to leave it, and the answer waits for that."""
    if conduct.resetting is not None:
        raise ValueError("the rig is being reset already")
    if conduct.on.axes.at_fault() is not None:
        conduct.on.axes.reset_faults()
        conduct.resetting = (number, conduct.clock() + RESET_S)
        return
    stands = conduct.stands()
    if stands is not None:
        raise ValueError(stands)
    conduct.finish_reset()
