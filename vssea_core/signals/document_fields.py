"""Fields that several kinds of signals share: an angle, a time, the length of a move."""

from vssea_core.fields import parameter


def angle(default: float, title: str, symbol: str, meaning: str = "") -> float:
    """Return a field [rad] of a little more than one turn to either side."""
    field: float = parameter(
        default, title, unit="rad", symbol=symbol, low=-6.3, high=6.3, typical=(-1.0, 1.0), step=0.01, meaning=meaning
    )
    return field


def seconds(default: float | None, title: str, meaning: str, low: float = 0.0, high: float = 1e4) -> float:
    """Return a field [s]."""
    field: float = parameter(
        default, title, unit="s", low=low, high=high, typical=(low, min(10.0, high)), step=0.01, meaning=meaning
    )
    return field


def move_duration(default: float) -> float:
    """Return the field for the length [s] of one move."""
    field: float = parameter(
        default, "duration", unit="s", low=0.02, high=60.0, typical=(0.2, 4.0), step=0.01, meaning="Time of one move."
    )
    return field


def frequency(default: float, title: str, symbol: str, meaning: str, low: float = 0.0, high: float = 50.0) -> float:
    """Return a field [Hz]."""
    field: float = parameter(
        default, title, unit="Hz", symbol=symbol, low=low, high=high, typical=(max(low, 0.05), min(10.0, high)), step=0.01,
        scale="log", meaning=meaning,
    )
    return field
