"""controller.json and controller.mat say all that a controller elsewhere needs, in the numbers that the tick uses."""

import io
import json
import math
from typing import Any

import numpy as np
import pytest
import scipy.io

from tests.core.controller_from_json import JsonController
from tests.core.exported_tunings import TUNINGS
from vssea_core.control.law import GAINS
from vssea_core.control.observer_design import position_form, velocity_exact
from vssea_core.control.packing import OBSERVER, ROWS_AT
from vssea_core.control.tuning import Tuning
from vssea_core.export.bundle import c_files, json_file, mat_file, zipped
from vssea_core.export.numbers import controller_numbers
from vssea_core.export.tables import tables_of
from vssea_core.export.vectors import vectors_of
from vssea_core.scenario import Scenario
from vssea_core.scenarios import NOMINAL, REALISTIC

every_tuning = pytest.mark.parametrize("scenario", TUNINGS.values(), ids=TUNINGS)


def read(scenario: Scenario) -> Any:
    return json.loads(json_file(scenario))


@every_tuning
def test_a_controller_written_from_the_json_alone_answers_as_the_tick(scenario: Scenario) -> None:
    vectors, controller = vectors_of(scenario), JsonController(read(scenario))
    answers = np.array([controller.tick(x) for x in vectors.inputs])
    assert np.allclose(
        answers, vectors.outputs[:, :2], rtol=0.0, atol=1e-9 * np.abs(vectors.outputs[:, :2]).max(axis=0)
    )


@every_tuning
def test_every_number_has_a_unit_and_a_meaning(scenario: Scenario) -> None:
    document = read(scenario)

    def names(part: Any) -> Any:
        return {name: names(value) for name, value in part.items()} if isinstance(part, dict) else None

    units = names(document["units"])
    assert units == names(document["meanings"])
    assert units == {name: names(document[name]) for name in units}
    assert {"timing", "model", "gains", "observer", "stiffness_loop", "controller"} <= set(units)


@every_tuning
def test_the_document_holds_the_tuning_it_was_made_from(scenario: Scenario) -> None:
    assert Tuning.model_validate_json(json.dumps(read(scenario)["tuning"])) == scenario.tuning


@every_tuning
def test_gains_are_those_of_the_ticks_array_to_the_last_bit(scenario: Scenario) -> None:
    document, prepared = read(scenario), tables_of(scenario).prepared
    rows = prepared[ROWS_AT:].reshape(len(document["gains"]["k"]), -1)
    assert rows.shape[1] == GAINS + 2 * OBSERVER
    for name, columns in (("K", slice(0, 4)), ("S", slice(4, 7)), ("Kx", slice(7, 11)), ("N_r", 11)):
        if name in document["gains"]:
            assert np.array_equal(document["gains"][name], rows[:, columns])
    assert {"K", "Kx", "S"} & set(document["gains"])


def test_observer_matrices_are_those_of_the_design() -> None:
    for part, matrix in zip(("A", "h", "b0", "b1"), velocity_exact(100.0, 1e-3), strict=True):
        assert np.array_equal(read(NOMINAL)["observer"]["motor"][part], [matrix])
    model = REALISTIC.tuning.model
    designed = position_form(100.0, model.link_damping / model.link_inertia, 1e-3)
    for part, matrix in zip(("A", "B0", "B1", "M"), designed, strict=True):
        assert np.allclose(read(REALISTIC)["observer"]["link"][part], [matrix], rtol=1e-15, atol=0.0)


def test_a_table_covers_the_rigs_stiffness_evenly_in_its_logarithm() -> None:
    gains = read(TUNINGS["schedule"])["gains"]
    assert len(gains["k"]) == 33
    assert np.allclose(gains["k"], np.geomspace(20.0, 1000.0, 33), rtol=1e-13)
    assert gains["ln_k_first"] == math.log(20.0)


def test_the_gains_of_the_stiffness_loop_are_those_of_equation_19() -> None:
    loop = read(NOMINAL)["stiffness_loop"]
    assert loop["K_p"] == pytest.approx(1e-4 * 120.0**2)
    assert loop["K_d"] == pytest.approx(2.0 * 120.0 * 1e-4 - 1e-4)


def plain(value: Any) -> Any:
    """What scipy read from a .mat, as dicts, lists and numbers, with the axis over the stiffness first again."""
    if hasattr(value, "_fieldnames"):
        return {name: plain(getattr(value, name)) for name in value._fieldnames}
    return value.tolist() if isinstance(value, np.ndarray) else value


def flat(part: Any, prefix: str = "") -> dict[str, Any]:
    if not isinstance(part, dict):
        return {prefix: part}
    return {name: leaf for key, value in part.items() for name, leaf in flat(value, f"{prefix}.{key}").items()}


@every_tuning
def test_the_mat_file_holds_what_the_json_holds(scenario: Scenario) -> None:
    document = controller_numbers(scenario)
    held = scipy.io.loadmat(io.BytesIO(mat_file(scenario)), squeeze_me=True, struct_as_record=False)["controller"]
    read_back, expected = flat(plain(held)), flat(document)
    assert set(read_back) == set(expected)
    for name, value in expected.items():
        back = read_back[name]
        if isinstance(value, str):
            assert (back if isinstance(back, str) else "") == value, name
        elif isinstance(value, list) and isinstance(value[0], str):
            assert [str(line) for line in back] == value
        else:
            array = np.array(value, float)
            if name.startswith((".gains", ".observer")):
                array = np.moveaxis(array, 0, -1) if array.ndim else array
            assert np.array_equal(np.squeeze(array), back), name


def test_matrices_in_the_mat_file_are_matrices() -> None:
    held = scipy.io.loadmat(io.BytesIO(mat_file(NOMINAL)))["controller"][0, 0]
    assert held["gains"][0, 0]["K"].shape == (4, 1)
    assert held["observer"][0, 0]["link"][0, 0]["A"].shape == (3, 3)
    table = scipy.io.loadmat(io.BytesIO(mat_file(TUNINGS["schedule"])))["controller"][0, 0]
    assert table["gains"][0, 0]["K"].shape == (4, 33)
    assert table["observer"][0, 0]["motor"][0, 0]["A"].shape == (5, 5, 33)


def test_equal_controllers_give_equal_bytes() -> None:
    assert zipped(c_files(REALISTIC)) == zipped(c_files(REALISTIC))
