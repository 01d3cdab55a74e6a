"""What may be asked of the analysis: one loop at once, or a long task. The axes are those of vssea_core.analysis.axes."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from vssea_core.scenario import Scenario

AxisName = Literal[
    "spring", "link_inertia", "motor_inertia", "link_damping", "motor_damping", "delay_s", "torque_lag_s", "stiffness",
    "bandwidth", "poles",
]  # fmt: skip
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]


class _Asked(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class LoopRequest(_Asked):
    """Which loop: a scenario's tuning at a stiffness, on its own model or on the scenario's true actuator."""

    scenario: Scenario | None = Field(None, description="The live scenario if there is none.")
    stiffness: float | None = Field(
        None, gt=0.0, le=1e5, strict=True, description="N·m/rad; the commanded one if there is none."
    )
    plant: Literal["model", "actuator"] = Field(
        "model", description="model: the plant the controller believes in. actuator: the scenario's true one."
    )


class AxisRequest(_Asked):
    """One axis of a map; without a range the usual one."""

    name: AxisName
    count: int = Field(40, ge=2, le=400, strict=True)
    low: Number | None = None
    high: Number | None = None


class MapRequest(LoopRequest):
    """A map over two axes: of stability, or of the worst margins of both breaks."""

    kind: Literal["stability_map", "margin_map"]
    x: AxisRequest
    y: AxisRequest


class MarginsAsked(_Asked):
    """Margins that a bandwidth must leave; phase in rad."""

    gain_up: float = Field(1.0, ge=1.0, le=100.0)
    gain_down: float = Field(1.0, ge=0.0, le=1.0)
    phase: float = Field(0.0, ge=0.0, le=3.0)
    delay_s: float = Field(0.0, ge=0.0, le=0.1)
    disk: float = Field(0.0, ge=0.0, le=2.0)


class BandwidthRequest(LoopRequest):
    """Stable sets of the observer bandwidth g, for each stiffness and for all mismatches at once."""

    kind: Literal["bandwidth_sets"]
    stiffnesses: list[Annotated[float, Field(gt=0.0, le=1e5)]] = Field(
        default_factory=lambda: [20.0, 50.0, 100.0, 200.0, 400.0, 800.0, 1000.0], min_length=1, max_length=60
    )
    mismatches: list[dict[str, Number]] = Field(default=[{}], min_length=1, max_length=32)
    least: MarginsAsked = MarginsAsked()
    low: float = Field(5.0, gt=0.0, le=2000.0)
    high: float = Field(1000.0, gt=0.0, le=5000.0)


class WorstCaseRequest(LoopRequest):
    """The worst plant of a box, by search, and certified by simulation of the nonlinear plant."""

    kind: Literal["worst_case"]
    box: dict[str, tuple[Number, Number]] = Field(
        default_factory=lambda: {
            "spring": (0.8, 1.25), "link_inertia": (0.7, 1.5), "motor_inertia": (0.9, 1.1), "delay_s": (0.0, 1e-3),
        },
        min_length=1,
        max_length=10,
    )  # fmt: skip
    criterion: Literal["growth", "disk"] = "disk"
    certify: bool = True


class PaperRequest(_Asked):
    """The paper's figures and claims, reproduced."""

    kind: Literal["paper"]
