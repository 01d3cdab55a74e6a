"""The states of a rig's session as a table: which command in which state, and the sentence that refuses it elsewhere."""

from backend.loop import messages
from backend.loop.messages import Command, State

ALL: frozenset[State] = frozenset(
    ("starting", "connected", "homing", "ready", "armed", "running", "stopping", "stopped", "fault")
)
ON: frozenset[State] = ALL - {"starting"}
WATCHED: frozenset[State] = frozenset(("homing", "armed", "running"))
"""States in which the operator's page and the server have to show signs of life."""
CLOSED: frozenset[State] = frozenset(("armed", "running"))
DRIVEN: frozenset[State] = WATCHED | {"stopping"}
"""States in which the rig is driven on purpose."""

ALLOWED: dict[type[Command], frozenset[State]] = {
    messages.Connect: frozenset(("starting",)),
    messages.Home: frozenset(("connected", "ready")),
    messages.Arm: frozenset(("ready",)),
    messages.Disarm: CLOSED,
    messages.Follow: frozenset(("armed",)),
    messages.Hold: frozenset(("running",)),
    messages.Jog: CLOSED,
    messages.GoTo: frozenset(("armed",)),
    messages.Disconnect: ALL,
    messages.Reset: frozenset(("stopped", "fault")),
    messages.Install: ON,
    messages.SetReference: ON,
    messages.SetStiffness: ON,
    messages.SetDisturbances: ON,
}
"""Commands a rig obeys, each in which states; the others are a simulation's."""

WHAT: dict[type[Command], str] = {
    messages.Connect: "this session is connected already",
    messages.Home: "a rig can be homed only when it is connected or ready",
    messages.Arm: "a rig can be armed only when it is ready",
    messages.Disarm: "only an armed rig can be disarmed",
    messages.Follow: "a rig can follow a reference only when it is armed",
    messages.Hold: "only a moving rig can be told to hold",
    messages.Jog: "only an armed rig can be jogged",
    messages.GoTo: "a rig can go to a position only when it is armed",
    messages.Reset: "only a stopped rig or one at fault can be reset",
}
WAY_ON: dict[State, str] = {
    "starting": "connect it first",
    "connected": "home it first",
    "homing": "wait for the end of homing, or stop it",
    "ready": "arm it first",
    "armed": "disarm it first",
    "running": "hold it first",
    "stopping": "wait until it has stopped",
    "stopped": "reset it first",
    "fault": "clear the cause, then reset it",
}
SIMULATION_ONLY: dict[type[Command], str] = {
    messages.Load: "a rig keeps its scenario; disconnect it first, or set reference, stiffness and tuning one by one",
    messages.Plan: "a rig makes no timed changes; set them by hand",
    messages.Pause: "a rig's time cannot be held; hold the link or stop the rig instead",
    messages.Resume: "a rig's time cannot be held, so it needs no resuming; arm it, then follow",
    messages.Step: "a rig's time cannot be stepped",
    messages.SetPace: "a rig runs at its own pace",
}
NO_HINT: dict[type[Command], frozenset[State]] = {
    messages.Reset: frozenset(("connected", "homing", "ready", "armed", "running")),
    messages.Disarm: frozenset(("connected", "ready")),
    messages.Hold: frozenset(("connected", "ready", "armed")),
    messages.Arm: frozenset(),
}

AFTER_STOP: dict[State, State] = {
    "connected": "stopped",
    "ready": "stopped",
    "homing": "stopping",
    "armed": "stopping",
    "running": "stopping",
}
"""Where STOP leads; every other state is as safe already and stays."""


def refusal(command: Command, state: State) -> str | None:
    """Return why `command` is refused in `state` of a rig's session, or None if it is allowed."""
    kind = type(command)
    if kind in SIMULATION_ONLY:
        return SIMULATION_ONLY[kind]
    if state in ALLOWED[kind]:
        return None
    if kind is messages.Connect:
        return WHAT[kind]
    what = WHAT.get(kind, "there is no rig")
    hint = "" if state in NO_HINT.get(kind, ()) else f": {WAY_ON[state]}"
    return f"{what}; this one is {'not connected' if state == 'starting' else state}{hint}"
