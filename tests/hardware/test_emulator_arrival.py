"""When a frame arrived is told by the kernel, not by when this process was woken."""

import selectors
import socket
import time
from types import SimpleNamespace

import pytest

from backend.emulator import socketcand

STALL_S = 0.05


@pytest.mark.skipif(socketcand.STAMPS is None, reason="this system does not tell when data arrived")
def test_a_frame_that_waited_for_this_process_has_the_time_of_its_arrival(monkeypatch: pytest.MonkeyPatch) -> None:
    arrivals: list[float] = []
    late = SimpleNamespace(monotonic=lambda: time.monotonic() + STALL_S, time=lambda: time.time() + STALL_S)
    with selectors.DefaultSelector() as selector:
        server = socketcand.SocketcandServer(0, selector, lambda _id, _data, arrived: arrivals.append(arrived))

        def turn() -> None:
            for key, events in selector.select(5.0):
                key.data(events)

        with socket.create_connection(("127.0.0.1", server.port)) as client:
            turn()
            client.sendall(b"< open can0 >< rawmode >")
            turn()
            monkeypatch.setattr(socketcand, "time", late)
            ages = []
            while len(ages) < 500 and (not ages or ages[-1] < STALL_S):  # the kernel begins a moment after it was asked
                client.sendall(b"< send 080 0  >")
                turn()
                ages.append(late.monotonic() - arrivals[-1])
        server.close()
    assert ages[-1] >= STALL_S
