"""What the control loop promises, one turn at a time: states, commands, pace and faults."""

from collections.abc import Iterator

import numpy as np
import pytest

from backend.loop import messages
from backend.loop.messages import Done, Refused
from backend.loop.warm import compile_kernels
from backend.telemetry.ring import EPOCH, WIDTH
from tests.backend.loop_bench import Bench, prepared
from vssea_core.actuator.parameters import Actuator, EquilibriumMotor
from vssea_core.control.tuning import StateFeedback
from vssea_core.scenario import Scenario
from vssea_core.scenarios import NOMINAL, REALISTIC
from vssea_core.signals.disturbances import load_at
from vssea_core.signals.documents import ConstantStiffness, MoveReference, SineReference
from vssea_core.signals.references import change_reference
from vssea_core.simulation.kernel import run
from vssea_core.simulation.run import simulate

AT_ONCE = NOMINAL.model_copy(update={"reference": SineReference(fade_in_s=0.0)})

# Limits would turn divergence into a limit cycle.
STRONG = REALISTIC.model_copy(
    update={
        "actuator": Actuator(
            motor=EquilibriumMotor(peak_torque=1e4, continuous_torque=1e4, no_load_speed=1e3, stall_torque=1e5)
        )
    }
)


@pytest.fixture
def bench() -> Iterator[Bench]:
    opened = Bench()
    yield opened
    opened.close()


@pytest.mark.parametrize("scenario", [NOMINAL, REALISTIC], ids=lambda scenario: scenario.name)
def test_a_live_session_is_the_simulation_sample_for_sample(bench: Bench, scenario: Scenario) -> None:
    bench.load(scenario)
    bench.turns(3999)
    live = bench.reader.since(0).samples[:, :WIDTH]
    assert np.array_equal(live, simulate(scenario.model_copy(update={"duration_s": 4.0})).rows)


def test_a_paused_session_writes_nothing_until_it_steps_and_resumes(bench: Bench) -> None:
    bench.load(NOMINAL)
    bench.turns(9)
    assert bench.ask(messages.Pause()) == Done(2, pytest.approx(0.010))
    bench.turns(5)
    assert bench.reader.written == 10
    assert bench.ask(messages.Step(2500)) == Done(3, pytest.approx(2.510))
    assert (bench.reader.written, bench.loop.state) == (2510, "paused")
    bench.ask(messages.Resume())
    bench.turns(9)
    assert np.allclose(np.diff(bench.channel("time")), 0.001)
    assert bench.changes() == ["running", "paused", "running"]


@pytest.mark.parametrize("command", [messages.Pause(), messages.Resume(), messages.Step(1)], ids=repr)
def test_a_command_that_does_not_fit_the_state_is_refused_with_the_state(
    bench: Bench, command: messages.Command
) -> None:
    bench.load(NOMINAL, run=isinstance(command, messages.Resume | messages.Step))
    answer = bench.ask(command)
    assert isinstance(answer, Refused)
    assert bench.loop.state in answer.sentence


def test_before_a_scenario_every_command_is_refused(bench: Bench) -> None:
    answer = bench.ask(messages.Reset())
    assert isinstance(answer, Refused)
    assert "starting" in answer.sentence


def test_a_reset_starts_a_new_epoch_at_zero_and_repeats_the_run(bench: Bench) -> None:
    bench.load(AT_ONCE)
    bench.turns(199)
    bench.ask(messages.Reset())
    bench.turns(199)
    samples = bench.reader.since(0).samples
    first, second = samples[samples[:, EPOCH] == 1], samples[samples[:, EPOCH] == 2]
    assert len(first) == len(second) == 200
    assert np.array_equal(first[:, :WIDTH], second[:, :WIDTH])


def test_a_loop_that_follows_a_dead_one_goes_on_counting_epochs(bench: Bench) -> None:
    bench.load(NOMINAL)
    bench.load(NOMINAL)
    bench.loop = bench.new_loop()
    bench.load(NOMINAL)
    assert bench.epochs().tolist() == [1, 2, 3]


def test_a_live_change_of_the_reference_is_continuous(bench: Bench) -> None:
    bench.load(AT_ONCE)
    bench.turns(700)
    bench.ask(messages.SetReference(MoveReference(origin=-1.0, target=1.0, start_s=0.0)))
    bench.turns(1000)
    reference = bench.channel("reference")
    speed, jump = np.abs(np.diff(reference)), np.abs(np.diff(reference, 2))
    assert speed.max() < 0.01
    assert jump.max() < 5e-4  # a jump of 1 rad would be 1 here
    assert np.ptp(reference) > 1.0


def test_a_new_tuning_is_in_force_from_the_next_sample_on(bench: Bench) -> None:
    bench.load(NOMINAL)
    bench.turns(4)
    faster = NOMINAL.tuning.model_copy(update={"controller": StateFeedback(natural_frequency=30.0)})
    bench.ask(messages.Install(faster, prepared(NOMINAL, faster), 2))
    assert bench.channel("tuning_id").tolist() == [1] * 5 + [2]


def test_a_new_stiffness_is_approached_and_reached(bench: Bench) -> None:
    bench.load(NOMINAL)
    bench.ask(messages.SetStiffness(ConstantStiffness(stiffness=400.0)))
    bench.turns(2000)
    stiffness = bench.channel("stiffness")
    assert np.abs(np.diff(stiffness)).max() < 20.0
    assert stiffness[-1] == pytest.approx(400.0, rel=0.01)


@pytest.mark.parametrize(("period_s", "pace"), [(0.001, 1.0), (0.001, 0.05), (0.001, 4.0), (0.0005, 1.0), (0.002, 0.5)])
def test_session_time_runs_at_the_pace_asked(bench: Bench, period_s: float, pace: float) -> None:
    timing = NOMINAL.timing.model_copy(update={"sample_time_s": period_s})
    bench.load(NOMINAL.model_copy(update={"timing": timing}), run=False)
    bench.ask(messages.SetPace(pace))
    bench.send(messages.Resume())
    asked_s = bench.turns(500)
    assert bench.reader.written * period_s == pytest.approx(asked_s * pace)


def test_an_unstable_tuning_ends_in_a_fault_with_a_reason_and_no_exception(bench: Bench) -> None:
    bench.load(STRONG)
    wild = STRONG.tuning.model_copy(update={"controller": StateFeedback(natural_frequency=500.0)})
    bench.ask(messages.Install(wild, prepared(STRONG, wild), 2))
    bench.turns(5000)
    assert bench.changes() == ["running", "fault"]
    assert "Diverged at t = " in (bench.reason() or "")
    assert np.isfinite(bench.reader.since(0).samples).all()
    assert isinstance(bench.ask(messages.Resume()), Refused)
    written = bench.reader.written
    bench.turns(10)
    assert bench.reader.written == written


def test_the_loop_leaves_when_the_web_process_is_gone(bench: Bench) -> None:
    bench.load(NOMINAL)
    bench.pipe.closed = True
    bench.loop.run()
    assert bench.loop.leaving


def test_a_missed_period_is_counted_and_its_sample_is_not_made_up_for(bench: Bench) -> None:
    bench.load(NOMINAL)
    wakes = iter([0.0, 0.0, 0.0105, 0.0, 0.0])  # the third sleep is ten periods too long

    def sleep(duration_s: float) -> None:
        bench.slept_s += duration_s + next(wakes)
        bench.pipe.closed = bench.slept_s > 0.014

    bench.sleep = sleep  # type: ignore[method-assign]
    bench.loop._pacer.restart()
    before = bench.reader.written
    bench.loop.run()
    assert bench.reader.overruns == 10
    assert bench.reader.written - before == 5


def test_nothing_is_left_to_compile_once_the_loop_turns(bench: Bench) -> None:
    compile_kernels()
    bench.load(NOMINAL)
    bench.ask(messages.SetReference(MoveReference()))
    bench.ask(messages.SetPace(4.0))  # several samples a turn
    bench.turns(3)
    bench.flag.raise_()
    bench.turns(3)
    simulate(NOMINAL.model_copy(update={"duration_s": 0.01}))
    assert [len(entry.signatures) for entry in (run, change_reference, load_at)] == [1, 1, 1]
