"""Headings of a rig's own log: which channel they mean, and what turns their unit into ours."""

import math
import re
from typing import NamedTuple

from backend.recordings.layout import FIELDS

PER_TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0}
"""Seconds of each unit of time."""
ANGLES = {"rad": 1.0, "mrad": 1e-3, "urad": 1e-6, "deg": math.pi / 180.0, "rev": 2.0 * math.pi, "turn": 2.0 * math.pi}
TORQUES = {"Nm": 1.0, "mNm": 1e-3, "kNm": 1e3, "uNm": 1e-6, "Nmm": 1e-3, "Ncm": 1e-2}


def _units() -> dict[str, dict[str, float]]:
    """Return for each of our units the factor of every unit that may be given instead."""
    known = {
        "s": PER_TIME,
        "µs": {unit: 1e6 * s for unit, s in PER_TIME.items()},
        "rad": ANGLES,
        "N·m": TORQUES,
        "": {"": 1.0},
    }
    for power, ours in ((1, "rad/s"), (2, "rad/s2"), (3, "rad/s3"), (4, "rad/s4")):
        known[ours] = {f"{angle}/s{power if power > 1 else ''}": factor for angle, factor in ANGLES.items()}
    known["rad/s"] |= {"rpm": 2.0 * math.pi / 60.0, "rev/min": 2.0 * math.pi / 60.0}
    for power, ours in ((1, "N·m/s"), (2, "N·m/s2")):
        known[ours] = {f"{torque}/s{power if power > 1 else ''}": factor for torque, factor in TORQUES.items()}
    known["N·m/rad"] = {f"{t}/{a}": tf / af for t, tf in TORQUES.items() for a, af in ANGLES.items()}
    return known


def plain_unit(unit: str) -> str:
    """Return a unit in one way of writing: `N m`, `N·m` and `N*m` are Nm, `°` is deg, `rad/s²` is rad/s2."""
    text = unit.strip().translate(str.maketrans("²³⁴µμ", "234uu")).replace("^", "").replace("°", "deg")
    text = re.sub(r"[\s·⋅*.]", "", text)
    text = re.sub(r"\bdegrees?\b", "deg", text)
    text = re.sub(r"\b(radians?)\b", "rad", text)
    text = re.sub(r"\b(turns|revs|revolutions?)\b", "rev", text)
    text = re.sub(r"\bsec(onds?)?\b", "s", text)
    return {"1/min": "rpm", "r/min": "rpm", "U/min": "rpm", "dps": "deg/s", "-": "", "1": ""}.get(text, text)


UNITS = {plain_unit(ours) if ours != "µs" else "us": factors for ours, factors in _units().items()}
"""By our unit, plainly written: factors by the unit given, plainly written."""


class Guess(NamedTuple):
    """What a heading says: the channel (None: not one of ours), its unit as written, the factor into our unit (None: unknown)."""

    channel: str | None
    unit: str
    factor: float | None


def guessed(heading: str) -> Guess:
    """Return what a heading such as `theta_l (deg)` or `link_position [rad]` means."""
    name, unit = split_heading(heading)
    channel = _NAMES.get(_plain_name(name))
    if channel is None:
        return Guess(None, unit, None)
    return Guess(channel, unit, factor_of(unit, channel))


def factor_of(unit: str, channel: str) -> float | None:
    """Return what a number in `unit` is multiplied by to be in the channel's own; no unit given is the channel's own."""
    if not unit:
        return 1.0
    own = next(field.unit for field in FIELDS if field.name == channel)
    return UNITS[plain_unit(own)].get(plain_unit(unit))


def units_for(channel: str) -> str:
    """Return the units that a channel may be given in, for a sentence."""
    own = next(field.unit for field in FIELDS if field.name == channel)
    return ", ".join(unit or "none" for unit in UNITS[plain_unit(own)])


def split_heading(heading: str) -> tuple[str, str]:
    """Return name and unit of a heading; the unit stands in brackets at its end, or after the last underscore or slash."""
    text = heading.strip().strip('"')
    found = re.fullmatch(r"(.*?)\s*[\[(]\s*(.*?)\s*[\])]", text)
    if found:
        return found[1].strip(), found[2]
    name, _, last = text.rpartition("_")
    if name and _plain_name(text) not in _NAMES and _plain_name(name) in _NAMES:
        return name, last
    return text, ""


def _plain_name(name: str) -> str:
    return re.sub(r"[\s_,.\-]", "", name.lower())


_GREEK = {"θ": "theta", "τ": "tau", "δ": "delta", "σ": "sigma", "ν": "nu"}


def _names() -> dict[str, str]:
    """Return channels by every name that stands for them: their own, their symbol, the symbol in Latin letters, their label."""
    known: dict[str, str] = {}
    for field in FIELDS:
        latin = "".join(_GREEK.get(letter, letter) for letter in field.symbol)
        for name in (field.name, field.symbol, latin, field.label):
            if name:
                known.setdefault(_plain_name(name), field.name)
    more = {
        "timestamp": "time", "zeit": "time", "position": "link_position", "q": "link_position", "theta": "link_position",
        "setpoint": "reference", "ref": "reference", "target": "reference", "torque": "motor_torque",
    }  # fmt: skip
    return {**more, **known}


_NAMES = _names()
