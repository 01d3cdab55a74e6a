"""Time of one tick of the exported C controller, beside the compiled tick on the same inputs in the same process's run."""

import statistics
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from tests.compiler import find_compiler
from tests.core.exported_tunings import TUNINGS
from vssea_core.export.bundle import c_files
from vssea_core.export.tables import tables_of
from vssea_core.export.ticks import OUTPUTS, answered
from vssea_core.export.vectors import vectors_of
from vssea_core.scenario import Scenario

NAMES = ("nominal", "realistic", "layer", "super_twisting", "predict_position", "schedule")
REPEATS, PASSES = 30, 100
OPTIONS = ("-std=c99", "-O2", "-ffp-contract=off")
TIMER = f"""
#include <stdio.h>
#include <time.h>

#include "vssea_controller.h"
#include "vssea_test_vectors.h"

int main(void)
{{
    volatile double torque;
    int repeat, pass, tick;

    for (repeat = 0; repeat < {REPEATS}; repeat++) {{
        clock_t begun = clock();

        for (pass = 0; pass < {PASSES}; pass++) {{
            vssea_controller_t controller;
            vssea_output_t out;

            vssea_controller_init(&controller);
            for (tick = 0; tick < VSSEA_TICKS; tick++) {{
                const double *in = vssea_inputs[tick];
                const vssea_measurement_t y = {{in[0], in[1], in[2], in[3], in[4], in[5]}};
                const vssea_torques_t torques = {{in[6], in[7], in[8], in[9] != 0.0}};
                const vssea_reference_t reference = {{{{in[10], in[11], in[12], in[13], in[14]}},
                                                     {{in[15], in[16], in[17], in[18], in[19]}}}};
                const vssea_stiffness_reference_t stiffness = {{{{in[20], in[21], in[22]}}, {{in[23], in[24], in[25]}}}};

                vssea_controller_step(&controller, &y, &torques, &reference, &stiffness, &out);
                torque = out.motor_torque;
            }}
        }}
        printf("%.9g\\n", (double)(clock() - begun) / CLOCKS_PER_SEC / {PASSES} / VSSEA_TICKS);
    }}
    (void)torque;
    return 0;
}}
"""


def times_in_c(scenario: Scenario, compiler: str) -> list[float]:
    """Return the time of one step [s], REPEATS times."""
    with tempfile.TemporaryDirectory(prefix="vssea-export-") as folder:
        for name, content in c_files(scenario).items():
            Path(folder, name).write_bytes(content)
        Path(folder, "timer.c").write_text(TIMER)
        command = [compiler, *OPTIONS, "-o", "timer", "vssea_controller.c", "timer.c", "-lm"]
        subprocess.run(command, cwd=folder, check=True)
        listing = subprocess.run([Path(folder, "timer")], capture_output=True, text=True, check=True)
    return [float(line) for line in listing.stdout.split()]


def times_compiled(scenario: Scenario) -> list[float]:
    """Return the time of one compiled tick [s], REPEATS times, on the processor clock as in C."""
    vectors, tables = vectors_of(scenario), tables_of(scenario)
    outputs, times = np.empty((len(vectors.inputs), OUTPUTS)), []
    for _ in range(REPEATS):
        begun = time.process_time()
        for _ in range(PASSES):
            answered(tables.prepared, tables.predicts, vectors.inputs, outputs)
        times.append((time.process_time() - begun) / PASSES / len(outputs))
    return times


def main() -> None:
    """Print best and median time of a tick, in C and compiled, for tunings that differ in what they cost."""
    compiler = find_compiler()
    console = Console(width=120)
    if compiler is None:
        console.print("No C compiler found: install gcc or clang, or set CC to its path.")
        return
    table = Table(
        "tuning", "C, best", "C, median", "compiled, best", "compiled, median", title="one tick of the controller"
    )
    for name in NAMES:
        times = times_in_c(TUNINGS[name], compiler), times_compiled(TUNINGS[name])
        table.add_row(
            name, *(f"{1e9 * each:.0f} ns" for pair in times for each in (min(pair), statistics.median(pair)))
        )
    console.print(table)
    console.print(
        f"{Path(compiler).name} {' '.join(OPTIONS)}; {REPEATS} repeats of {PASSES} passes over the test vectors"
    )
