"""What the loop writes behind the channels of a sample: the run it belongs to, its sample time, and how the tick went."""

from backend.telemetry.ring import EPOCH, EXECUTION_US, LATENESS_US, PERIOD_S, Samples


def stamp(rows: Samples, epoch: int, period_s: float, late_s: float, execution_us: float) -> None:
    """Fill the columns after the channels of `rows` (n, COLUMNS), the tick having started `late_s` too late."""
    rows[:, EPOCH] = epoch
    rows[:, PERIOD_S] = period_s
    rows[:, LATENESS_US] = late_s * 1e6
    rows[:, EXECUTION_US] = execution_us
