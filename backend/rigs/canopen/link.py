"""The link encoder in the cycle: a node of its own, or the second encoder of a drive in that drive's answer."""

from backend.rigs.canopen.answer import Answer
from backend.rigs.canopen.objects import FORMS, Entry
from backend.rigs.canopen.scaling import LinkPosition
from backend.rigs.rig_file import LinkEncoder


def link_entry(link: LinkEncoder) -> Entry:
    """Return the encoder's position as an entry of a PDO."""
    return Entry(link.index, link.subindex, link.bits, FORMS[link.bits])


class LinkChannel:
    """The link's position [rad]; `place` is where it stands in the answer."""

    def __init__(self, answer: Answer, place: int, counter: LinkPosition) -> None:
        self.answer = answer
        self.position = 0.0
        self._place, self._counter = place, counter

    @property
    def age(self) -> int:
        """Cycles since the position was new."""
        return self.answer.age

    def settle(self) -> None:
        """Take over what this cycle brought."""
        if self.answer.age == 0 and self.answer.content is not None:
            self.position = self._counter.take(self.answer.content[self._place])
