"""What the control port is asked, and what it answers."""

from typing import Any

from backend.emulator.emulator import Emulator
from backend.emulator.faults import FAULTS, Faults, RefusedRequest, load

KEYS = ("do", "name", "node", "axis", "value")
"""What a request may say; `axis` is motor, stiffness or link, another name for a node."""
AXIS_NODES = {"motor": 1, "stiffness": 2, "link": 3}


def answer(emulator: Emulator, faults: Faults, request: dict[str, Any]) -> dict[str, Any]:
    """Do what a request says and return the reply; a request that cannot be done gets {"error": sentence}."""
    try:
        return _done(emulator, faults, request)
    except RefusedRequest as refusal:
        return {"error": str(refusal)}


def _done(emulator: Emulator, faults: Faults, request: dict[str, Any]) -> dict[str, Any]:
    unknown = [key for key in request if key not in KEYS]
    if unknown:
        raise RefusedRequest(f"{unknown[0]!r} is not known; expected {', '.join(KEYS)}")
    match request.get("do"):
        case "fault":
            faults.set(str(request.get("name")), _value(request), _node(request))
            return {"ok": True, "faults": list(faults.standing)}
        case "load":
            load(emulator, _value(request))
            return {"ok": True}
        case "clear":
            faults.clear()
            return {"ok": True, "faults": []}
        case "state":
            return {"ok": True, **emulator.state(), "faults": list(faults.standing)}
        case "watch":
            emulator.watch()
            return {"ok": True}
        case "peaks":
            return {"ok": True, **emulator.peaks()}
        case "faults":
            return {"ok": True, "faults": FAULTS}
        case other:
            raise RefusedRequest(f"{other!r} is not known; expected fault, clear, load, state, watch, peaks or faults")


def _value(request: dict[str, Any]) -> float | None:
    value = request.get("value")
    if value is None:
        return None
    try:
        return float(int(value, 0)) if isinstance(value, str) else float(value)
    except (TypeError, ValueError) as error:
        raise RefusedRequest(f"value {value!r} is no number") from error


def _node(request: dict[str, Any]) -> int | None:
    node, axis = request.get("node"), request.get("axis")
    if axis is not None:
        if axis not in AXIS_NODES:
            raise RefusedRequest(f"there is no axis {axis!r}; expected motor, stiffness or link")
        return AXIS_NODES[axis]
    if node is not None and (not isinstance(node, int) or isinstance(node, bool)):
        raise RefusedRequest(f"node {node!r} is no node number; expected 1, 2 or 3")
    return node
