"""After a fault: back to the last tuning that ran without one, as a change like any other. The rig stays at fault."""

import logging
from typing import TYPE_CHECKING

from backend.problem import Problem
from backend.session.changes import Changes
from backend.session.good_tuning import PROVED_S, GoodTuning

if TYPE_CHECKING:
    from backend.session.session import Session

logger = logging.getLogger(__name__)


async def return_to_good(session: "Session", good: GoodTuning) -> None:
    """Put the last good tuning in force, with its entry in the history."""
    last = good.last
    if last is None:
        return
    try:
        async with session.turn:
            await session.parts.change_in_turn("tuning", Changes(replace=last.model_dump(mode="json")), "session")
    except Problem as problem:
        logger.warning("the last good tuning was not put in force: %s", problem.detail)
        session.note("tuning", f"the last good tuning is not back: {problem.detail}", "session", "warning")
        return
    session.note(
        "tuning",
        f"back to the last tuning that ran {PROVED_S:g} s without a fault; Reset when the cause of the fault is gone",
        "session",
        "warning",
    )
