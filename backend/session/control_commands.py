"""Control over the rig: taken, renewed, given up, asked for and handed over; every page sees who has it."""

import secrets
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from backend.problem import Problem
from backend.session.arguments import Nothing
from backend.session.heartbeat import Heartbeat
from backend.session.operator_lease import LONGEST_LEASE_S, OperatorLease, Party
from backend.session.rig_arguments import Handing, TakingControl
from backend.telemetry.beats import LEASE_S

if TYPE_CHECKING:
    from backend.session.session import Session

Message = dict[str, Any]
BY_REST = "REST"
DRIVEN = frozenset({"homing", "armed", "running"})
"""States in which a rig moves, or holds, for its operator."""


class ControlCommands:
    """A page is known by the key of its websocket; any other caller gets a key when it takes or asks for control."""

    def __init__(self, session: "Session", clock: Callable[[], float]) -> None:
        self._session = session
        self._lease = OperatorLease(clock)
        self.heart = Heartbeat(self._lease)
        self._pages: dict[str, str] = {}

    # ---- pages

    def join(self, name: str) -> str:
        """Return the key of a page that has connected."""
        key = secrets.token_urlsafe(16)
        self._pages[key] = name
        return key

    def leave(self, key: str) -> None:
        """Take a page's control away as it closes; a rig under torque stops."""
        name = self._pages.pop(key, "")
        if self._lease.leave(key):
            self._note(f"{name} has closed and lost control", name, "warning")
            self._stop("the operator's page closing")

    # ---- for others

    def check(self, key: str | None) -> None:
        """Raise Problem 403 unless a key is that of who is in control."""
        self._lease.check(key)

    def document(self) -> Message:
        """Return who is in control, as docs/protocol.md has it."""
        lease = self._lease
        holder, left_s = lease.holder, lease.left_s
        return {
            "needed": self._session.rig.connected,
            "operator": holder and holder.name,
            "asking": [party.name for party in lease.asking],
            "expires_in_s": None if left_s is None else round(left_s, 3),
        }

    def watch(self) -> None:
        """Tell of a lease that ended by silence, and stop what moves under it."""
        silent = self._lease.expired()
        if silent is not None:
            self._note(f"{silent.name} was silent for {silent.length_s:g} s and lost control", silent.name, "warning")
            self._stop("the operator's silence")

    def take_for_connecting(self, key: str | None) -> Party:
        """Give control to who connects a rig, for as long as may be: nothing can move yet.

        Raises Problem 403 if another one has it.
        """
        party = self._party(key, LONGEST_LEASE_S)
        self._lease.take(party)
        return party

    def keep(self, party: Party) -> None:
        """Begin the lease of who has connected a rig anew, unless another one took control while that lasted."""
        if self._lease.holder is None or self._lease.holds(party.key):
            self._lease.take(party)
        self.heart.beat_operator()

    async def end(self) -> None:
        """End control and signs of life with the rig's connection."""
        self._lease.end()
        await self.heart.end()

    # ---- commands

    async def take(self, asked: TakingControl, by: str, key: str | None) -> Message:
        """Take control that nobody has; answers the key that proves it."""
        self.watch()  # whose lease has ended leaves nothing that moves to who takes it
        party = self._party(key, asked.expires_s)
        was = self._lease.holds(party.key)
        self._lease.take(party)
        self.heart.beat_operator()
        if not was:
            self._note(f"{party.name} took control", party.name)
        return {"key": party.key, "expires_s": party.length_s}

    async def renew(self, _: Nothing, by: str, key: str | None) -> Message:
        """Say that the operator lives."""
        self._lease.renew(key)
        self.heart.beat_operator()
        return {}

    async def release(self, _: Nothing, by: str, key: str | None) -> Message:
        """Give control up; a rig under torque stops."""
        name = self._name(key)
        self._lease.release(key)
        self._note(f"{name} gave up control", name)
        self._stop("the operator giving up control")
        return {}

    async def ask(self, asked: TakingControl, by: str, key: str | None) -> Message:
        """Ask who has it for control."""
        party = self._party(key, asked.expires_s)
        holder = self._lease.ask(party)
        self._note(f"{party.name} asks {holder.name} for control", party.name)
        return {"key": party.key, "operator": holder.name}

    async def hand(self, asked: Handing, by: str, key: str | None) -> Message:
        """Give control to a page, or to another caller who asks for it."""
        self._lease.check(key)
        to = next((party for party in self._lease.asking if party.name == asked.to), None)
        page = next((other for other, name in self._pages.items() if name == asked.to), None)
        if page is not None:
            to = Party(page, asked.to)
        if to is None:
            raise Problem(404, "No such page", f"{asked.to} is not connected and does not ask for control.")
        name = self._name(key)
        self._lease.hand(key, to)
        self.heart.beat_operator()
        self._note(f"{name} handed control to {to.name}", name)
        return {}

    def _stop(self, by: str) -> None:
        """Stop a rig under torque: signs of life of who takes control next must not keep it going."""
        session = self._session
        if session.rig.connected and (session.status.state in DRIVEN or session.rig.commands.driving):
            session.runs.stop_at_once(by)

    def _party(self, key: str | None, length_s: float) -> Party:
        """Return the caller; a page lives by its own signs of life, so its lease is always the shortest."""
        if key is not None and key in self._pages:
            return Party(key, self._pages[key], LEASE_S)
        known = key if key is not None and self._lease.holds(key) else secrets.token_urlsafe(16)
        return Party(known, BY_REST, length_s)

    def _name(self, key: str | None) -> str:
        return self._pages.get(key or "", BY_REST)

    def _note(self, text: str, by: str, severity: Any = "info") -> None:
        self._session.note("control", text, by, severity)
        self._session.tell_state()
