"""Whether the tuning in force fits where a stiffness jog can end: worked out beside, so that no jog ever waits for it."""

from typing import TYPE_CHECKING

from backend.problem import Problem
from backend.rigs.rig_file import Limits
from backend.session.planning import planned
from vssea_core.actuator.parameters import Actuator, Timing
from vssea_core.control.tuning import Tuning
from vssea_core.scenario import Scenario
from vssea_core.signals.documents import ConstantStiffness

if TYPE_CHECKING:
    from backend.session.session import Session

REFUSED = 422
Question = tuple[Tuning, Actuator, Timing, Limits]


class JogEnds:
    """Knows of both ends of the rig's stiffness range, for the newest tuning that was looked at."""

    def __init__(self, session: "Session") -> None:
        self._session = session
        self._of: Question | None = None
        self._unfit: dict[float, str] = {}
        self._failure = ""
        self._looking = False

    def look(self) -> None:
        """Begin to work it out if it is not known of the tuning in force; a failure is tried again."""
        question = self._question()
        if question is not None and question != self._of and not self._looking:
            self._looking = True
            self._session.spawn(self._work_out())

    def check(self, stiffness: float) -> None:
        """Raise Problem 409 unless the tuning is known to fit at an end [N m/rad]; `wait` says that it soon will be."""
        self.look()
        if self._of != self._question():
            raise self._unknown(stiffness)
        why = self._unfit.get(stiffness)
        if why is not None:
            raise Problem(
                409, "Cannot jog", f"The jog could end at {stiffness:g} N·m/rad, and the tuning does not fit there: {why} "
                "Tune it more slowly, or command a stiffness nearer by.",
            )  # fmt: skip

    def _unknown(self, stiffness: float) -> Problem:
        if self._failure:
            sentence = f"Whether the tuning fits at {stiffness:g} N·m/rad, where the jog could end, is unknown: {self._failure}"
            return Problem(409, "Cannot jog", f"{sentence} Try again.")
        sentence = f"The tuning is being checked at {stiffness:g} N·m/rad, where the jog could end; hold on."
        return Problem(409, "Cannot jog yet", sentence, members={"wait": True})

    async def _work_out(self) -> None:
        try:
            while (question := self._question()) is not None and question != self._of:
                scenario, limits = self._session.scenario, question[-1]
                ends = limits.stiffness_low, limits.stiffness_high
                reasons = {end: await self._unfit_because(scenario, end) for end in ends}
                self._of, self._failure = question, ""
                self._unfit = {end: why for end, why in reasons.items() if why}
        except Problem as problem:
            self._failure = problem.detail
        finally:
            self._looking = False

    async def _unfit_because(self, scenario: Scenario, stiffness: float) -> str:
        """Return why the tuning would be unstable at a stiffness [N m/rad], "" if it fits. Raises Problem if that failed."""
        there = scenario.model_copy(update={"stiffness_reference": ConstantStiffness(stiffness=stiffness)})
        try:
            await planned(self._session.design, there)
        except Problem as problem:
            if problem.status != REFUSED:
                raise
            return problem.detail.removesuffix(" The old tuning keeps running.")
        return ""

    def _question(self) -> Question | None:
        session = self._session
        file, scenario = session.rig.file, session.scenario
        if file is None or not session.rig.connected:
            return None
        return scenario.tuning, scenario.actuator, scenario.timing, file.limits
