"""Waiting for a batch while its server is away: up to a limit, in injected time."""

from typing import Any

import pytest

from backend.client.batches import AWAY_LIMIT_S, Batches
from backend.client.problem import VsseaError

RUNNING, DONE = {"state": "running"}, {"state": "done"}
AWAY = VsseaError("cannot be reached")


class Server:
    """Answers as it was told, by the time; a minute has 60 askings."""

    def __init__(self, *answers: Any) -> None:
        self.answers, self.time_s = list(answers), 0.0

    def json(self, *_: Any, **__: Any) -> Any:
        answer = self.answers.pop(0) if len(self.answers) > 1 else self.answers[0]
        if isinstance(answer, VsseaError):
            raise answer
        return answer

    def sleep(self, seconds: float) -> None:
        self.time_s += seconds

    def wait(self) -> Any:
        batches = Batches(self, lambda *_: None)  # type: ignore[arg-type]
        return batches.wait("b1", every_s=1.0, clock=lambda: self.time_s, sleep=self.sleep)


def test_a_server_that_comes_back_within_the_limit_is_waited_for() -> None:
    assert Server(RUNNING, *[AWAY] * int(AWAY_LIMIT_S - 1), RUNNING, *[AWAY] * 50, DONE).wait() == DONE


def test_a_server_that_stays_away_is_told_at_the_limit() -> None:
    server = Server(RUNNING, AWAY)
    with pytest.raises(VsseaError, match="cannot be reached"):
        server.wait()
    assert server.time_s == AWAY_LIMIT_S


@pytest.mark.parametrize("answers", [(AWAY,), (RUNNING, VsseaError("There is no batch", 404))])
def test_a_server_that_was_never_there_or_that_refuses_is_not_waited_for(answers: tuple[Any, ...]) -> None:
    server = Server(*answers)
    with pytest.raises(VsseaError):
        server.wait()
    assert server.time_s <= 1.0
