"""All files of an export, by name."""

import io
import json
import re
import zipfile

from vssea_core.export.c_source import TEST_SOURCE, c_sources, packaged
from vssea_core.export.mat import as_mat
from vssea_core.export.numbers import controller_numbers
from vssea_core.export.vectors import as_c_header, as_csv, vectors_of
from vssea_core.scenario import Scenario

LIST_OF_NUMBERS = re.compile(r"\[\n([-+\d.eE,\s]+)\n\s*\]")
"""What reads better on one line; a string of JSON holds no line break."""
EARLIEST = (1980, 1, 1, 0, 0, 0)
"""Time stamp of files in the archive, so that equal controllers give equal bytes."""


def json_file(scenario: Scenario) -> bytes:
    """Return controller.json: export.numbers, UTF-8. Raises ValueError if a design has no solution."""
    text = json.dumps(controller_numbers(scenario), indent=1, ensure_ascii=False, allow_nan=False)
    return (LIST_OF_NUMBERS.sub(lambda found: f"[{' '.join(found[1].split())}]", text) + "\n").encode()


def mat_file(scenario: Scenario) -> bytes:
    """Return controller.mat. Raises ValueError if a design has no solution."""
    return as_mat(controller_numbers(scenario))


def c_files(scenario: Scenario) -> dict[str, bytes]:
    """Return the C files with test vectors and README.txt. Raises ValueError if a design has no solution."""
    vectors = vectors_of(scenario)
    texts = {
        **c_sources(scenario),
        TEST_SOURCE: packaged(TEST_SOURCE),
        "vssea_test_vectors.h": as_c_header(vectors),
        "test_vectors.csv": as_csv(vectors),
        "README.txt": readme(scenario),
    }
    return {name: text.encode() for name, text in texts.items()}


def all_files(scenario: Scenario) -> dict[str, bytes]:
    """Return everything: numbers as JSON and for MATLAB, C files. Raises ValueError if a design has no solution."""
    return {"controller.json": json_file(scenario), "controller.mat": mat_file(scenario), **c_files(scenario)}


def zipped(files: dict[str, bytes]) -> bytes:
    """Return `files` as a zip archive with one folder."""
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as held:
        for name, content in files.items():
            held.writestr(zipfile.ZipInfo(f"vssea_controller/{name}", EARLIEST), content, zipfile.ZIP_DEFLATED)
    return archive.getvalue()


def readme(scenario: Scenario) -> str:
    """Return README.txt: how to build and test the C files, the order of this tuning's tick, what is not included."""
    numbers = controller_numbers(scenario)
    order = "\n\n".join(numbers["order_of_tick"])
    return f"""VSSEA controller: {scenario.name}
{numbers["software_version"]} (schema {numbers["schema_version"]}), T = {scenario.timing.sample_time_s:g} s

Build and test

    cc -std=c99 -O2 -ffp-contract=off -o test_vssea_controller vssea_controller.c test_vssea_controller.c -lm
    ./test_vssea_controller

It runs the test vectors, which were made by the compiled tick of the program, and prints the largest relative error; it ends
with 1 above 1e-12. Do not use -ffast-math. On the target you need vssea_controller.h, vssea_controller.c and
vssea_controller_numbers.h; call vssea_controller_init once and vssea_controller_step at every tick.

The order of a tick

{order}

Not included: limits of the drives, watchdog, checks of the sensors, state machine, emergency stop. They belong to the rig.
"""
