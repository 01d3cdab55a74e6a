"""The controller as C99: fixed source from the package, and the tuning's numbers as one generated header."""

import importlib.resources
from collections.abc import Iterable

import numpy as np

from vssea_core import __version__
from vssea_core.control.law import POSITION_FORM
from vssea_core.export.tables import POSITION_NUMBERS, VELOCITY_NUMBERS, Tables, tables_of
from vssea_core.scenario import Scenario

SOURCES = ("vssea_controller.h", "vssea_controller.c")
TEST_SOURCE = "test_vssea_controller.c"
NUMBERS = "vssea_controller_numbers.h"
KINDS = {
    "CONTROLLER": ("STATE_FEEDBACK", "SLIDING_MODE", "BASELINE"),
    "SWITCH": ("SGN", "LAYER", "TANH", "SUPER_TWISTING"),
    "FORM": ("VELOCITY", "POSITION", "OFF"),
}
"""Names of the values 0, 1, ... that control.law gives to each choice."""


def c_sources(scenario: Scenario) -> dict[str, str]:
    """Return the C files of the scenario's controller by name. Raises ValueError if a design has no solution."""
    return {name: packaged(name) for name in SOURCES} | {NUMBERS: numbers_header(scenario)}


def packaged(name: str) -> str:
    """Return a C file of this package."""
    return (importlib.resources.files("vssea_core.export") / "c" / name).read_text("utf-8")


def literal(value: float) -> str:
    """Return `value` as a C double that reads back as the same bits."""
    text = f"{value:.17g}"
    return text if any(mark in text for mark in ".e") else f"{text}.0"


def braced(values: Iterable[float]) -> str:
    """Return an initialiser of one line."""
    return "{" + ", ".join(literal(value) for value in values) + "}"


def numbers_header(scenario: Scenario) -> str:
    """Return vssea_controller_numbers.h, which vssea_controller.c alone includes."""
    tables = tables_of(scenario)
    law = tables.law
    part = POSITION_NUMBERS if law.observer == POSITION_FORM else VELOCITY_NUMBERS
    each = part.stop - part.start
    rows = np.hstack([tables.gains, tables.link[:, part], tables.motor[:, part]])
    defined = {
        **_choices(tables),
        "PREDICT": f"{int(tables.predicts)} /* 1: the law acts on the state one sample ahead */",
        "DIFFERENCE": f"{int(law.difference_gain != 0.0)} /* 1: velocities are filtered differences of positions */",
        "SAMPLE_TIME": f"{literal(law.period)} /* T [s] */",
        "LINK_INERTIA": f"{literal(law.link_inertia)} /* J_l [kg m^2] */",
        "LINK_DAMPING": f"{literal(law.link_damping)} /* b_l [N m s/rad] */",
        "MOTOR_INERTIA": f"{literal(law.motor_inertia)} /* J_e [kg m^2], gear side */",
        "MOTOR_DAMPING": f"{literal(law.motor_damping)} /* b_e [N m s/rad], gear side */",
        "SPRING_CONSTANT": f"{literal(law.spring_constant)} /* Y_tau [N m rad^3], Eq. (3) */",
        "STIFFNESS_INERTIA": f"{literal(law.stiffness_inertia)} /* J_ms [kg m^2] */",
        "STIFFNESS_DAMPING": f"{literal(law.stiffness_damping)} /* b_ms [N m s/rad] */",
        "STIFFNESS_P": f"{literal(law.stiffness_p)} /* w^2 = K_p / J_ms of Eq. (19) [1/s^2] */",
        "STIFFNESS_D": f"{literal(law.stiffness_d)} /* 2 zeta w = (K_d + b_ms) / J_ms of Eq. (19) [1/s] */",
        "RATE_SHARE": f"{literal(law.rate_share)} /* 1: tau_s' with its theta_ms' term */",
        "MOVING_SHARE": f"{literal(law.moving_share)} /* 1: R with its theta_ms terms */",
        "SWITCHING_GAIN": f"{literal(law.switching_gain)} /* rho [rad/s^4], Eq. (16) */",
        "LAYER_WIDTH": f"{literal(law.layer_width)} /* phi [rad/s^3] */",
        "TWISTING_GAIN": f"{literal(law.twisting_gain)} /* L [rad/s^5] */",
        "DIFFERENCE_KEEP": literal(law.difference_keep),
        "DIFFERENCE_GAIN": f"{literal(law.difference_gain)} /* [1/s] */",
        "OBSERVER": f"{each} /* numbers of one observer */",
        "ROW": f"{rows.shape[1]} /* k1..k4, s1..s3, x1..x4, N_r, link observer, motor observer */",
        "ROWS": f"{len(rows)} /* over the stiffness; 1: constant gains */",
        "FIRST_LN_K": literal(tables.first_ln_k),
        "ROWS_PER_LN_K": literal(tables.rows_per_ln_k),
    }
    names = "\n".join(f"#define VSSEA_{name} {value}" for name, value in defined.items())
    table = ",\n    ".join(braced(row.tolist()) for row in rows)
    return (
        f"/* Numbers of the controller {_comment(scenario.name)}, made by VSSEA {__version__}; for vssea_controller.c alone. */\n"
        f"#ifndef VSSEA_CONTROLLER_NUMBERS_H\n#define VSSEA_CONTROLLER_NUMBERS_H\n\n{names}\n\n"
        f"static const double vssea_rows[VSSEA_ROWS][VSSEA_ROW] = {{\n    {table},\n}};\n\n"
        "static const double vssea_stiffness_observer[VSSEA_OBSERVER] = "
        f"{braced(tables.stiffness[part].tolist())};\n\n#endif\n"
    )


def _choices(tables: Tables) -> dict[str, str]:
    """Return the values of every choice by name, and which of them this tuning makes."""
    law = tables.law
    made = {"CONTROLLER": law.controller, "SWITCH": law.switch, "FORM": law.observer}
    values = {name: str(value) for names in KINDS.values() for value, name in enumerate(names)}
    return values | {choice: f"VSSEA_{KINDS[choice][int(value)]}" for choice, value in made.items()}


def _comment(name: str) -> str:
    """Return a scenario's name as it may stand in a C comment."""
    plain = "".join(c if c.isascii() and (c.isalnum() or c in " .-_") else "_" for c in name)
    return f"'{plain}'"
