"""Declaring a parameter once: value, range, unit, symbol and source in one place.

`parameter` and `choice` make pydantic fields whose metadata reaches the JSON schema, from which sliders, REST
documentation and the parameter reference are made.
"""

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

Basis = Literal["D", "P", "E", "C"]
"""Where a default comes from: datasheet, paper, engineering estimate, or our choice."""


class Part(BaseModel):
    """A frozen part of the scenario document; unknown names and non-finite numbers are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


def parameter(
    default: Any,
    title: str,
    *,
    unit: str,
    low: float,
    high: float,
    symbol: str = "",
    typical: tuple[float, float] | None = None,
    step: float | None = None,
    scale: Literal["linear", "log"] = "linear",
    meaning: str = "",
    equation: str = "",
    basis: Basis = "C",
) -> Any:
    """Return a numeric field with its range [low, high] in `unit` and what a user wants to know of it.

    `typical` is the range of a slider, inside the permitted one; `step` is its finest useful change.
    """
    return Field(
        default,
        strict=True,
        ge=low,
        le=high,
        title=title,
        description=meaning or None,
        json_schema_extra={
            "unit": unit,
            "symbol": symbol,
            "typical": list(typical or (low, high)),
            "step": step,
            "scale": scale,
            "equation": equation,
            "basis": basis,
        },
    )


def choice(default: Any, title: str, *, meaning: str = "", equation: str = "") -> Any:
    """Return a field whose type is a `Literal` or a bool."""
    return Field(default, title=title, description=meaning or None, json_schema_extra={"equation": equation})


def kind(name: str) -> Any:
    """Return the discriminator field of one alternative of a union."""
    return Field(name, title="kind")
