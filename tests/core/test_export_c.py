"""The exported C controller is the compiled tick: same inputs, same answers to 1e-12, for every form of the tuning."""

import ctypes
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

from tests.core.exported_tunings import TUNINGS, tuned
from vssea_core.actuator.parameters import Timing
from vssea_core.export.bundle import c_files
from vssea_core.export.c_source import NUMBERS, literal
from vssea_core.export.tables import tables_of
from vssea_core.export.ticks import INPUTS, OUTPUTS, answered
from vssea_core.export.vectors import Vectors, exercise, vectors_of
from vssea_core.scenario import Scenario
from vssea_core.scenarios import NOMINAL
from vssea_core.signals.smooth_step import moved
from vssea_core.simulation.run import simulate

STRICT = ["-std=c99", "-O2", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror", "-pedantic"]
every_tuning = pytest.mark.parametrize("scenario", TUNINGS.values(), ids=TUNINGS)


def written(folder: Path, scenario: Scenario) -> Path:
    for name, content in c_files(scenario).items():
        (folder / name).write_bytes(content)
    return folder


def compiled(compiler: str, folder: Path, *options: str, sources: tuple[str, ...], output: str) -> Path:
    command = [compiler, *STRICT, *options, "-o", output, *sources, "-lm"]
    outcome = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert outcome.returncode == 0, outcome.stderr
    return folder / output


def checked(compiler: str, folder: Path) -> subprocess.CompletedProcess[str]:
    sources = ("vssea_controller.c", "test_vssea_controller.c")
    program = compiled(compiler, folder, sources=sources, output="test_vssea_controller")
    return subprocess.run([program], capture_output=True, text=True, check=False)


@every_tuning
def test_the_c_controller_answers_as_the_compiled_tick(scenario: Scenario, tmp_path: Path, c_compiler: str) -> None:
    outcome = checked(c_compiler, written(tmp_path, scenario))
    assert outcome.returncode == 0, outcome.stdout
    found = re.match(r"(\d+) ticks, largest relative error (\S+) ", outcome.stdout)
    assert found
    assert int(found[1]) == 300
    assert float(found[2]) <= 1e-12


@every_tuning
def test_the_vectors_are_the_simulations_own_torques(scenario: Scenario) -> None:
    vectors, run = vectors_of(scenario), simulate(exercise(scenario))
    assert np.array_equal(vectors.outputs[:, 0], run["motor_torque_demand"])
    assert np.array_equal(vectors.outputs[:, 6], run["sliding_variable"])


@every_tuning
def test_the_vectors_begin_at_rest_move_both_axes_and_meet_a_limit(scenario: Scenario) -> None:
    inputs = vectors_of(scenario).inputs
    limited, stiffness, link = inputs[:, 9], inputs[:, 20], inputs[:, 0]
    assert not inputs[0, 3:6].any()
    assert inputs[0, 6] > 0.0
    assert 0 < limited.sum() < len(inputs) - 50
    assert np.ptp(stiffness) > 5.0
    assert np.ptp(link) > 0.01


@pytest.mark.parametrize("period", [1e-4, 5e-3])
def test_other_sample_times_agree_too(period: float, tmp_path: Path, c_compiler: str) -> None:
    scenario = tuned(timing=Timing(sample_time_s=period))
    assert checked(c_compiler, written(tmp_path, scenario)).returncode == 0


def test_a_gain_that_is_off_by_a_millionth_is_noticed(tmp_path: Path, c_compiler: str) -> None:
    header = written(tmp_path, NOMINAL) / NUMBERS
    text = header.read_text()
    assert text.count("{160000.0,") == 1
    header.write_text(text.replace("{160000.0,", "{160000.16,"))
    outcome = checked(c_compiler, tmp_path)
    assert outcome.returncode == 1
    assert "largest relative error" in outcome.stdout


def test_what_is_not_a_number_is_noticed(tmp_path: Path, c_compiler: str) -> None:
    header = written(tmp_path, NOMINAL) / NUMBERS
    text, count = re.subn(r"(VSSEA_LINK_INERTIA) \S+", r"\1 0.0", header.read_text())
    assert count == 1
    header.write_text(text)
    outcome = checked(c_compiler, tmp_path)
    assert outcome.returncode == 1
    assert "is not a number" in outcome.stdout


@pytest.mark.parametrize("name", ["nominal", "schedule_sliding_predict"])
def test_the_c_controller_keeps_nothing_of_its_own_and_allocates_nothing(
    name: str, tmp_path: Path, c_compiler: str
) -> None:
    folder = written(tmp_path, TUNINGS[name])
    compiled(c_compiler, folder, "-c", sources=("vssea_controller.c",), output="vssea_controller.o")
    listing = subprocess.run(["nm", "-P", "vssea_controller.o"], cwd=folder, capture_output=True, text=True, check=True)
    symbols = [line.split()[:2] for line in listing.stdout.splitlines()]
    assert {"vssea_controller_step", "vssea_controller_init"} <= {symbol for symbol, kind in symbols if kind == "T"}
    assert not [symbol for symbol, kind in symbols if kind in "bBdDC"]
    assert not {symbol for symbol, kind in symbols if kind == "U"} & {"malloc", "calloc", "realloc", "free"}


def loaded(compiler: str, folder: Path, scenario: Scenario) -> ctypes.CDLL:
    written(folder, scenario)
    built = compiled(compiler, folder, "-shared", "-fPIC", sources=("vssea_controller.c",), output="controller.so")
    return ctypes.CDLL(str(built))


@pytest.fixture
def library(tmp_path: Path, c_compiler: str) -> ctypes.CDLL:
    return loaded(c_compiler, tmp_path, TUNINGS["super_twisting"])


def by_ctypes(library: ctypes.CDLL, inputs: np.ndarray) -> np.ndarray:
    memory, outputs = (ctypes.c_double * 23)(), np.empty((len(inputs), OUTPUTS))
    for x, y in zip(inputs, outputs, strict=True):
        following, answer = (ctypes.c_double * 23)(), (ctypes.c_double * OUTPUTS)()
        library.vssea_controller_flat(memory, (ctypes.c_double * INPUTS)(*x), following, answer)
        memory, y[:] = following, answer
    return outputs


@pytest.mark.parametrize("name", ["nominal", "schedule", "schedule_sliding_predict", "lqr_plant", "difference"])
def test_they_agree_where_no_rig_goes_too(name: str, tmp_path: Path, c_compiler: str) -> None:
    """Deflections to 3 rad, stiffnesses on both sides of the table, any torque, any reference."""
    random = np.random.default_rng(0)
    inputs = random.uniform(-3.0, 3.0, (400, INPUTS))
    inputs[:, 1] = inputs[:, 0] + random.uniform(-3.0, 3.0, 400)
    for column in (2, 20, 23):
        inputs[:, column] = random.uniform(20.0, 150.0, 400)
    inputs[:, 9] = random.integers(0, 2, 400)
    outputs, tables = np.empty((400, OUTPUTS)), tables_of(TUNINGS[name])
    answered(tables.prepared, tables.predicts, inputs, outputs)
    assert np.isfinite(outputs).all()
    in_c = by_ctypes(loaded(c_compiler, tmp_path, TUNINGS[name]), inputs)
    assert np.all(np.abs(in_c - outputs) <= 1e-12 * np.abs(outputs).max(axis=0))


def test_the_integral_stands_still_while_the_torque_is_limited(library: ctypes.CDLL) -> None:
    vectors: Vectors = vectors_of(TUNINGS["super_twisting"])
    twisting = by_ctypes(library, vectors.inputs)[:, 18]
    limited = vectors.inputs[1:, 9] != 0.0
    changes = np.diff(twisting)
    assert limited.any()
    assert not changes[limited].any()
    assert set(np.round(np.abs(changes[~limited]), 9)) == {0.0, 11.0}  # 1.1 L T sgn(sigma)


def test_a_controller_that_starts_anew_under_load_asks_for_what_holds(library: ctypes.CDLL) -> None:
    """d = f of the first tick: the torque asked for is the one that was applied, whatever the load."""
    still = np.zeros((1, INPUTS))
    still[0, 1:3], still[0, 6], still[0, 20] = (0.03, 53.7), 6.5, 53.7
    outputs = by_ctypes(library, still)
    assert outputs[0, 0] == pytest.approx(6.5, rel=1e-9)


@pytest.mark.parametrize("time", [-0.1, 0.0, 0.2, 0.35, 0.7, 0.9])
def test_the_move_is_that_of_the_core(library: ctypes.CDLL, time: float) -> None:
    move = (ctypes.c_double * 5)()
    library.vssea_smooth_move.argtypes = [ctypes.c_double] * 4 + [ctypes.POINTER(ctypes.c_double)]
    library.vssea_smooth_move(0.1, -0.4, time, 0.7, move)
    expected = moved(0.1, -0.4, time, 0.7)
    assert np.allclose(list(move), expected, rtol=1e-13, atol=0.0)


@pytest.mark.parametrize("value", [0.0, 20.0, -0.0, 1e-300, 1e20, 6.2e7, 1 / 3, -4.998333749916681e-07])
def test_a_number_reads_back_as_the_same_bits(value: float) -> None:
    text = literal(value)
    assert np.float64(text).tobytes() == np.float64(value).tobytes()
    assert re.search(r"[.e]", text)
