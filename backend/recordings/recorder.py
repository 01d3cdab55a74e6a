"""The recorder as the web process sees it: hears the session, keeps a writer process at work, tells pages how it stands."""

import asyncio
import logging
from collections import deque
from collections.abc import Callable
from itertools import count
from typing import Any, Literal

from backend.recordings.entries import begin_head, change_entry, command_entry, event_entry
from backend.recordings.messages import Answer, Begin, Ended, Hold, Item, Note, Stopped, Wrote
from backend.recordings.writer_link import WriterLink
from backend.session.events import Event
from backend.session.journal import Change, Run, Told
from backend.settings import Settings

logger = logging.getLogger(__name__)
State = Literal["starting", "recording", "idle", "off", "stopped"]
MOST_WAITING = 20_000
RUNS_KEPT = 8
RESTART_PAUSE_S = 0.5
LONGEST_PAUSE_S = 10.0


class Recorder:
    """A journal of the session, and the keeper of the writer. Nothing here waits for a disk."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._numbers = count(1)
        self._waiting: deque[Item] = deque(maxlen=MOST_WAITING)
        self._runs: dict[int, Begin] = {}
        self._wrote = Wrote(0, 0, None, None, 0, 0, 0)
        self._trouble: str | None = None
        self._link: WriterLink | None = None
        self._keeper: asyncio.Task[None] | None = None
        self._tell: Callable[[dict[str, Any]], None] = lambda _: None
        self._note: Callable[[str, bool], None] = lambda sentence, is_trouble: None
        self._ended: Callable[[str], None] = lambda _: None

    # ---- life

    def start(
        self,
        ring_name: str,
        tell: Callable[[dict[str, Any]], None],
        note: Callable[[str, bool], None],
        ended: Callable[[str], None],
    ) -> None:
        """Begin to record what the ring holds.

        `tell` reaches the pages, `note` the event log (a sentence, is it trouble); `ended` hears of each complete recording.
        """
        self._tell, self._note, self._ended = tell, note, ended
        if self._settings.recording:
            self._keeper = asyncio.create_task(self._keep(ring_name))

    async def stop(self) -> None:
        """Finish the present recording and end the writer."""
        if self._keeper is not None:
            self._keeper.cancel()
            await asyncio.gather(self._keeper, return_exceptions=True)
        if self._link is not None:
            await self._link.stop()
            self._link = None

    async def _keep(self, ring_name: str) -> None:
        """Keep a writer running; one that ends by itself is followed by another, which goes on where it was."""
        pause_s = RESTART_PAUSE_S
        while True:
            self._link = link = WriterLink(self._take)
            before = self._wrote.sample
            await link.start(ring_name, self._settings, self._resumed(), list(self._waiting))
            await link.ended.wait()
            await link.stop()
            self._note(
                "The recording process ended unexpectedly and is started anew; the ring keeps a minute for it.", True
            )
            pause_s = RESTART_PAUSE_S if self._wrote.sample > before else min(2 * pause_s, LONGEST_PAUSE_S)
            await asyncio.sleep(pause_s)

    def _resumed(self) -> tuple[Begin | None, str | None, int, int]:
        wrote = self._wrote
        run = next((run for run in self._runs.values() if _is_part_of(wrote.recording, run.head["id"])), None)
        return run, wrote.path, wrote.sample, wrote.item

    # ---- what pages see

    def present(self) -> str | None:
        """Return the id of the recording that is being written."""
        return self._wrote.recording if self._link is not None else None

    def of_run(self, epoch: int) -> str | None:
        """Return the id of the recording that holds the newest samples of a run, None if it is not recorded."""
        run = self._runs.get(epoch)
        if run is None or self._trouble is not None or not self._settings.recording:
            return None
        present, first = self.present(), run.head["id"]
        return present if _is_part_of(present, first) else first

    def progress(self) -> Wrote:
        """Return how far the writer is."""
        return self._wrote

    def document(self) -> dict[str, Any]:
        """Return how the recorder stands, as docs/protocol.md has it."""
        state, sentence = self._words()
        return {"state": state, "sentence": sentence, "recording": self.present(), "lost": self._wrote.lost}

    def _words(self) -> tuple[State, str]:
        wrote = self._wrote
        if not self._settings.recording:
            return "off", "Not recording: VSSEA_RECORDING is false."
        if self._trouble is not None:
            return "stopped", f"Not recording: {self._trouble}. The control goes on."
        if wrote.recording is None:
            return (
                ("idle", "Waiting for the first sample.") if wrote.item else ("starting", "The recorder is starting.")
            )
        lost = f", {wrote.lost} samples lost" if wrote.lost else ""
        return "recording", f"Recording, {wrote.size / 1e6:.1f} MB{lost}."

    # ---- what the writer says

    def _take(self, answer: Answer) -> None:
        if isinstance(answer, Wrote):
            if answer.lost > self._wrote.lost and answer.recording == self._wrote.recording:
                self._note(f"{answer.lost - self._wrote.lost} samples were not recorded: the disk was too slow", True)
            is_news = answer.recording != self._wrote.recording
            self._wrote = answer
            while self._waiting and self._waiting[0].number <= answer.item:
                self._waiting.popleft()
            if is_news:
                self._tell_state()
        elif isinstance(answer, Ended):
            self._ended(answer.recording)
        elif isinstance(answer, Stopped):
            self._trouble = answer.sentence or None
            self._note(
                f"Recording stopped: {answer.sentence}. The control goes on."
                if answer.sentence
                else "Recording goes on",
                bool(answer.sentence),
            )
            self._tell_state()

    def _tell_state(self) -> None:
        self._tell({"type": "recorder", "recorder": self.document()})

    # ---- what the session tells

    def begin(self, run: Run) -> None:
        """Hear that a run began."""
        scenario = run.scenario.model_dump(mode="json")
        begun = Begin(next(self._numbers), run.epoch, begin_head(run), scenario, run.tuning_id)
        self._runs[run.epoch] = begun
        for epoch in list(self._runs)[:-RUNS_KEPT]:
            del self._runs[epoch]
        self._send(begun)

    def change(self, change: Change) -> None:
        """Hear of a change in force."""
        number = next(self._numbers)
        self._send(Note(number, change.epoch, change_entry(number, change)))

    def command(self, command: Told) -> None:
        """Hear of a command, accepted or refused."""
        number = next(self._numbers)
        self._send(Note(number, command.epoch, command_entry(number, command)))

    def event(self, event: Event) -> None:
        """Hear of an event of the log."""
        number = next(self._numbers)
        run = self._runs.get(event.epoch)
        begin_ns = int(run.head["begin_ns"]) if run is not None else 0
        self._send(Note(number, event.epoch, event_entry(number, event, begin_ns)))

    def hold(self, sentence: str | None) -> None:
        """Stop recording for a reason of this side, such as a full quota; None: go on."""
        self._send(Hold(next(self._numbers), sentence))

    def _send(self, item: Item) -> None:
        if not self._settings.recording:
            return
        self._waiting.append(item)
        if self._link is not None:
            self._link.send(item)


def _is_part_of(recording: str | None, run: str) -> bool:
    return recording is not None and (recording == run or recording.startswith(f"{run}-"))
