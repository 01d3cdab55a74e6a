"""STOP in the loop: before everything else, at once, latched, and the stiffness axis holds."""

from collections.abc import Iterator

import numpy as np
import pytest

from backend.loop import messages
from backend.loop.messages import Refused
from tests.backend.loop_bench import Bench, prepared
from vssea_core.scenario import Scenario
from vssea_core.scenarios import NOMINAL, REALISTIC
from vssea_core.signals.documents import SineReference

BUSY = SineReference(amplitude=0.5, frequency_hz=0.5, fade_in_s=0.0)
BOTH = [scenario.model_copy(update={"reference": BUSY}) for scenario in (NOMINAL, REALISTIC)]


@pytest.fixture
def bench() -> Iterator[Bench]:
    opened = Bench()
    yield opened
    opened.close()


@pytest.mark.parametrize("scenario", BOTH, ids=lambda scenario: scenario.name)
def test_the_next_sample_has_no_motor_torque_and_the_stiffness_holds(bench: Bench, scenario: Scenario) -> None:
    bench.load(scenario)
    bench.turns(300)
    assert abs(bench.channel("motor_torque")[-1]) > 0.5
    before = bench.reader.written
    bench.flag.raise_()
    bench.turns(1000)
    torque = bench.channel("motor_torque")[before:]
    assert len(torque) == 1000
    assert (torque == 0.0).all()
    assert (bench.channel("motor_torque_demand")[before:] == 0.0).all()
    stiffness = bench.channel("stiffness_motor_position")
    assert np.abs(stiffness[before:] - stiffness[before - 1]).max() < 0.5  # of 31 to 116 rad
    assert np.abs(bench.channel("stiffness_motor_torque")[before:]).max() > 0.0
    assert bench.loop.state == "stopped"


def test_stop_goes_before_commands_that_came_earlier(bench: Bench) -> None:
    bench.load(BOTH[0])
    bench.turns(300)
    bench.send(messages.SetPace(4.0))
    bench.send(messages.SetReference(SineReference(amplitude=1.0)))
    bench.flag.raise_()
    before = bench.reader.written
    bench.turns(1)
    assert (bench.channel("motor_torque")[before:] == 0.0).all()
    reports = bench.pipe.outbox[-3:]
    assert [type(report) for report in reports] == [messages.Changed, messages.Done, messages.Done]


@pytest.mark.parametrize("latched", ["stopped", "fault"])
def test_nothing_but_a_reset_leaves_the_latch(bench: Bench, latched: str) -> None:
    bench.load(BOTH[0])
    bench.turns(200)
    if latched == "stopped":
        bench.flag.raise_()
        bench.turns(1)
    else:
        bench.loop._loop._state[0] = 2000.0  # type: ignore[union-attr]  # no input gets there on purpose
        bench.turns(1)
    assert bench.loop.state == latched
    for command in (messages.Pause(), messages.Resume(), messages.Step(5)):
        assert isinstance(bench.ask(command), Refused)
    tuning = NOMINAL.tuning
    bench.ask(messages.Install(tuning, prepared(NOMINAL, tuning), 2))
    bench.ask(messages.SetReference(BUSY))
    bench.ask(messages.SetStiffness(NOMINAL.stiffness_reference))
    bench.ask(messages.SetDisturbances(NOMINAL.disturbances))
    bench.ask(messages.SetPace(2.0))
    bench.flag.raise_()
    bench.turns(3)
    assert bench.loop.state == latched


@pytest.mark.parametrize("way", [messages.Reset(), "load"], ids=["reset", "load"])
def test_a_way_out_of_a_stop_leads_to_ready_and_needs_a_resume(bench: Bench, way: messages.Command | str) -> None:
    bench.load(BOTH[0])
    bench.turns(200)
    bench.flag.raise_()
    bench.turns(1)
    if isinstance(way, str):
        bench.load(BOTH[0], run=True)
    else:
        bench.ask(way)
    assert bench.loop.state == "ready"
    before = bench.reader.written
    bench.turns(5)
    assert bench.reader.written == before
    bench.ask(messages.Resume())
    bench.turns(300)
    assert bench.loop.state == "running"
    assert np.abs(bench.channel("motor_torque")[before:]).max() > 0.5


def test_a_stop_while_the_session_starts_keeps_it_from_running(bench: Bench) -> None:
    bench.flag.raise_()
    loop = bench.loop = bench.new_loop()
    bench.load(NOMINAL, run=True)
    bench.turns(5)
    assert (loop.state, bench.reader.written) == ("ready", 0)


def test_a_paused_session_can_be_stopped_and_then_not_resumed(bench: Bench) -> None:
    bench.load(NOMINAL)
    bench.ask(messages.Pause())
    bench.flag.raise_()
    assert isinstance(bench.ask(messages.Resume()), Refused)
    assert bench.loop.state == "stopped"
