"""The reference implementation keeps the laws it was derived from, and reproduces the theory's own numbers."""

from __future__ import annotations

import ast
from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np
import pytest

from .closed_loop import limited, simulate
from .law import Knowledge, link_torque
from .linear import closed_loop_matrix
from .observer import AuxiliaryObserver, PositionObserver, SampledObserver
from .parameters import Config, Controller, Encoders, Limits, Plant, Reference, StiffnessReference, Term
from .plant import advance, derivative, disturbance_over_period, spring_energy
from .signals import link_reference, smoothstep

T = 1e-3
CALM = (disturbance_over_period((), 0.0),) * 3
LOAD_FROM_3_S = (Term(3.0, start_s=3.0), Term(3.0, 0.5, start_s=3.0, kind="sine"))
VARIANTS = [Controller(method="exact"), Controller(method="first_order_hold"), Controller(form="position")]
NAMES = ["exact", "first_order_hold", "position"]


def rms(values: np.ndarray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def test_the_reference_imports_nothing_of_the_code_it_checks() -> None:
    for path in Path(__file__).parent.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom) and node.level == 0:
                names = [node.module or ""]
            for name in names:
                assert not name.startswith(("vssea", "backend")), f"{path.name} imports {name}"


def test_total_energy_is_conserved_without_losses_while_the_stiffness_motor_moves() -> None:
    plant = Plant(link_damping=0.0, motor_damping=0.0, stiffness_damping=0.0)
    inertias = np.array([plant.link_inertia, plant.motor_inertia, plant.stiffness_inertia])

    def energy(x: np.ndarray) -> float:
        return spring_energy(plant, x[2] - x[0], x[4]) + float(0.5 * inertias @ x[1:6:2] ** 2)

    state = np.array([0.0, 1.0, 0.2, -0.5, plant.stiffness_motor_position(200.0), 10.0, 0.0])
    start, position = energy(state), state[4]
    for k in range(100):
        state = advance(plant, state, k * T, T, 0.0, 0.0, CALM)
    assert abs(state[4] - position) > 1.0
    assert energy(state) == pytest.approx(start, rel=1e-11)


def test_a_balanced_preload_is_an_equilibrium() -> None:
    plant = Plant(coulomb_friction=5.6, torque_lag_s=1.6e-4)
    theta_ms, load = plant.stiffness_motor_position(200.0), 7.0
    deflection = 2.0 * np.arcsin(load * theta_ms**3 / plant.spring_constant)
    energy = spring_energy(plant, deflection, theta_ms)
    link_load = disturbance_over_period((Term(load),), 0.0)
    state = [0.3, 0.0, 0.3 + deflection, 0.0, theta_ms, 0.0, load]
    slope = derivative(plant, 0.0, state, load, -3.0 * energy / theta_ms, (link_load, *CALM[1:]))
    assert np.allclose(slope, 0.0, atol=1e-8)


@pytest.mark.parametrize("controller", VARIANTS, ids=NAMES)
def test_control_holds_a_preloaded_equilibrium_without_a_kick(controller: Controller) -> None:
    plant, load = Plant(spring="linear"), 3.0
    config = Config(
        plant=plant,
        controller=controller,
        stiffness=StiffnessReference(50.0),
        link_disturbance=(Term(load),),
        initial_state=(0.0, 0.0, load / 50.0, 0.0),
        initial_torque=load,
        duration_s=0.1,
    )
    run = simulate(config)
    assert abs(run["torque_applied"][0] - load) < 1e-9
    assert np.abs(run["torque_applied"] - load).max() < 1.0  # the stiffness motor settles against tau_back
    assert np.abs(run["tracking_error"]).max() < 1e-4


def test_a_zero_estimate_on_a_preloaded_spring_kicks_343_newton_metres() -> None:
    plant = Plant(spring="linear")
    none = np.zeros(3)
    known = Knowledge(0.0, 0.0, 3.0 / 50.0, 0.0, plant.stiffness_motor_position(50.0), 0.0, none, none, none)
    assert link_torque(Controller(), plant, np.zeros(5), known, 0.0)["torque"] == pytest.approx(-343.35, abs=0.01)


@pytest.mark.parametrize("spring", ["sine", "linear"])
def test_the_torque_gives_the_link_the_snap_it_was_computed_for(spring: Literal["sine", "linear"]) -> None:
    plant, h, none = Plant(spring=spring), 2e-4, np.zeros(3)
    x = np.array([0.1, 2.0, 0.9, -6.0, plant.stiffness_motor_position(100.0), 150.0, 0.0])
    reference = np.array([0.2, 1.0, -3.0, 500.0, 2e4])
    theta_ms_acceleration = 4000.0
    chosen = link_torque(Controller(), plant, reference, Knowledge(*x[:6], none, none, none), theta_ms_acceleration)
    torque_ms = -plant.stiffness_inertia * derivative(plant, 0.0, x, 0.0, 0.0, CALM)[5]
    torque_ms += plant.stiffness_inertia * theta_ms_acceleration

    def link_acceleration(step: float) -> float:
        moved = advance(plant, x, 0.0, step, chosen["torque"], torque_ms, CALM, "rk")
        return derivative(plant, 0.0, moved, 0.0, 0.0, CALM)[1]

    snap = (link_acceleration(h) - 2.0 * link_acceleration(0.0) + link_acceleration(-h)) / h**2
    assert snap == pytest.approx(chosen["snap"], rel=1e-4)


@pytest.mark.parametrize("g", [20.0, 100.0, 400.0])
def test_the_exactly_sampled_gain_has_the_closed_form_of_a_triple_pole(g: float) -> None:
    z = np.exp(-g * T)
    closed = [(1 - z) * (2 * z * z + 5 * z + 11) / (6 * T), (1 - z) ** 2 * (z + 2) / T**2, (1 - z) ** 3 / T**3]
    observer = SampledObserver(g, T)
    assert np.allclose(observer.gain, closed, rtol=1e-9)
    assert np.allclose(observer.c, [T, T**2 / 2, T**3 / 6], rtol=1e-12)


def test_twelve_states_split_into_one_observer_a_channel() -> None:
    rng = np.random.default_rng(1)
    rates = (1.0, 1.3)
    a = np.zeros((4, 4))
    a[0, 1] = a[2, 3] = 1.0
    a[1, 1], a[3, 3] = -rates[0], -rates[1]
    whole = AuxiliaryObserver(a, 100.0, T)
    parts = [AuxiliaryObserver(np.array([[-rate]]), 100.0, T) for rate in rates]
    x, force = rng.normal(size=4), rng.normal(size=4)
    whole.start(x, force)
    for part, i in zip(parts, (1, 3), strict=True):
        part.start(x[i : i + 1], force[i : i + 1])
    for _ in range(20):
        x_next, force_next = rng.normal(size=4), rng.normal(size=4)
        whole.update(x, force, x_next, force_next)
        for part, i in zip(parts, (1, 3), strict=True):
            one = slice(i, i + 1)
            part.update(x[one], force[one], x_next[one], force_next[one])
            assert np.allclose(whole.estimate(x_next)[:, i], part.estimate(x_next[one])[:, 0], rtol=1e-7, atol=1e-4)
        x, force = x_next, force_next


def test_the_exactly_sampled_form_estimates_a_quadratic_disturbance_without_error() -> None:
    observer = SampledObserver(100.0, T)
    disturbance = np.array([1.0, -2.0, 3.0])

    def velocity(t: float) -> float:
        return -(disturbance[0] * t + disturbance[1] * t**2 / 2 + disturbance[2] * t**3 / 6)

    for k in range(400):
        observer.update(velocity(k * T), 0.0, velocity((k + 1) * T), 0.0)
    end = 0.4
    exact = [disturbance @ [1.0, end, end**2 / 2], disturbance[1] + disturbance[2] * end, disturbance[2]]
    assert np.allclose(observer.d, exact, atol=1e-6)


@pytest.mark.parametrize("form", ["velocity", "position"])
def test_steady_errors_for_a_cubic_disturbance(form: str) -> None:
    g, step, c = 20.0, 1e-4, 6.0
    errors = np.zeros(3)
    position, auxiliary = PositionObserver(0.0, g, step), AuxiliaryObserver(np.zeros((1, 1)), g, step)
    position.start(0.0, 0.0)
    auxiliary.start(np.zeros(1), np.zeros(1))
    force = np.zeros(1)
    for k in range(15000):
        t = k * step
        after = t + step
        if form == "position":
            position.update(0.0, -c * after**5 / 120, 0.0)
            errors = c * np.array([after**3 / 6, after**2 / 2, after]) - position.x[2:]
        else:
            x_next = np.array([-c * after**4 / 24])
            auxiliary.update(np.array([-c * t**4 / 24]), force, x_next, force)
            errors = c * np.array([after**3 / 6, after**2 / 2, after]) - auxiliary.estimate(x_next)[:, 0]
    factors = [10.0, 10.0, 5.0] if form == "position" else [1.0, 3.0, 3.0]
    assert np.allclose(errors, c * np.array(factors) / g ** np.array([3, 2, 1]), rtol=0.01)


def test_a_sampled_quadruple_pole_splits() -> None:
    matrix = closed_loop_matrix(Controller(pole=8.0), Plant(), Plant(), 1000.0, 1000.0, T, 0)
    slow = np.log(np.linalg.eigvals(matrix).astype(complex)) / T
    slow = slow[np.argsort(np.abs(slow))][:4]
    assert np.allclose(np.sort_complex(slow), [-24.6, -4.4 - 4.7j, -4.4 + 4.7j, -4.1], atol=0.06)


def small_signal(
    controller: Controller, plant: Plant, model: Plant, delay: int, duration: float, integrator: str = "dop853"
) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
    """Matrix, initial xi and run for an initial state of 1e-6."""
    start = (1e-6, 2e-6, -1e-6, 1e-6)
    config = Config(plant, model, controller=controller, initial_state=start, duration_s=duration)
    run = simulate(replace(config, delay_samples=delay, integrator=integrator))
    matrix = closed_loop_matrix(controller, plant, model, 200.0, 200.0, T, delay)
    blocks = [run["link"][0], run["motor"][0]]
    if controller.form == "position":
        blocks = [np.concatenate([run["known"][0][2 * i : 2 * i + 2], block]) for i, block in enumerate(blocks)]
    lag = [0.0] if plant.torque_lag_s > 0.0 else []
    return matrix, np.concatenate([start, lag, *blocks, [0.0] * delay]), run


@pytest.mark.parametrize("delay", [0, 1])
@pytest.mark.parametrize("lag", [0.0, 1.6e-4])
@pytest.mark.parametrize("controller", VARIANTS, ids=NAMES)
def test_small_signals_follow_the_closed_loop_matrix(controller: Controller, lag: float, delay: int) -> None:
    plant = Plant(link_inertia=0.13, motor_damping=5.0, torque_lag_s=lag)
    matrix, xi, run = small_signal(controller, plant, Plant(), delay, 0.06)
    for k in range(len(run["t"])):
        assert np.allclose(run["state"][k, :4], xi[:4], rtol=1e-6, atol=1e-11), k
        xi = matrix @ xi


@pytest.mark.parametrize("controller", VARIANTS, ids=NAMES)
def test_growth_of_an_unstable_loop_is_its_largest_eigenvalue(controller: Controller) -> None:
    controller = replace(controller, observer_bandwidth=60.0)
    matrix, _, run = small_signal(controller, Plant(link_inertia=0.3), Plant(), 1, 1.6, "rk")
    radius = np.abs(np.linalg.eigvals(matrix)).max()
    assert radius > 1.003
    stride, y = (
        20,
        run["state"][1000:, 0],
    )  # by then the dominant pair alone is left: y[k+2s] = a y[k+s] - radius^2s y[k]
    columns = np.column_stack([y[stride:-stride], y[: -2 * stride]])
    product = -np.linalg.lstsq(columns, y[2 * stride :], rcond=None)[0][1]
    assert product ** (0.5 / stride) == pytest.approx(radius, abs=1e-5)


def test_sliding_inside_its_layer_is_state_feedback() -> None:
    layered = Controller(law="sliding_mode")
    matrix, xi, run = small_signal(layered, Plant(), Plant(), 0, 0.05)
    assert np.abs(run["sigma"]).max() < layered.boundary_layer
    assert np.allclose(run["state"][-1, :4], (np.linalg.matrix_power(matrix, 49) @ xi)[:4], rtol=1e-6, atol=1e-11)


def test_encoders_only_give_the_documented_noise_and_error() -> None:
    config = Config(
        plant=Plant(coulomb_friction=5.6),
        limits=Limits(peak_torque=74.0),
        encoders=Encoders.of_hardware(),
        controller=Controller(form="position"),
        reference=Reference(amplitude=0.5),
        link_disturbance=LOAD_FROM_3_S,
        duration_s=8.0,
        integrator="rk",
    )
    run = simulate(config)
    settled = run["t"] >= 4.0
    assert rms(np.diff(run["torque_applied"][settled])) == pytest.approx(0.86, abs=0.01)
    assert 1e3 * rms(run["tracking_error"][settled]) == pytest.approx(0.48, abs=0.005)


@pytest.mark.parametrize(("method", "expected"), [("exact", 8.6), ("first_order_hold", 8.7)])
def test_the_first_figure_scenario_tracks_within_nine_milliradians(method: str, expected: float) -> None:
    waves = (Term(3.0, start_s=3.0), Term(5.0, 0.5, start_s=3.0, kind="sine"), Term(2.0, 1.5, start_s=3.0, kind="sine"))
    config = Config(
        plant=Plant(link_inertia=0.12, link_damping=0.25, motor_inertia=3.3, motor_damping=6.0),
        limits=Limits(peak_torque=150.0),
        controller=Controller(method=method, observer_bandwidth=200.0, pole=8.0),
        reference=Reference("move", 1.0, duration_s=1.0),
        link_disturbance=waves,
        motor_disturbance=(Term(4.0, 0.7, start_s=3.0, kind="sine"),),
        duration_s=10.0,
        integrator="rk",
    )
    run = simulate(config)
    assert 1e3 * rms(run["tracking_error"][run["t"] >= 4.0]) == pytest.approx(expected, abs=0.1)


@pytest.mark.parametrize(("terms", "low", "high"), [("none", 300.0, 340.0), ("rate", 65.0, 80.0), ("all", 0.5, 1.0)])
def test_every_stiffness_term_is_needed_while_stiffness_falls(terms: str, low: float, high: float) -> None:
    config = Config(
        controller=Controller(stiffness_terms=terms),
        stiffness=StiffnessReference(1000.0, 20.0, start_s=1.0, duration_s=0.5, filter_bandwidth=60.0),
        link_disturbance=(Term(5.0),),
        duration_s=2.0,
        integrator="rk",
    )
    run = simulate(config)
    assert low < 1e3 * np.abs(run["tracking_error"][run["t"] >= 0.95]).max() < high


def test_the_fast_integrator_agrees_with_the_accurate_one() -> None:
    config = Config(
        plant=Plant(coulomb_friction=5.6, torque_lag_s=1.6e-4),
        reference=Reference(amplitude=0.5, fade_s=0.2),
        stiffness=StiffnessReference(400.0, 200.0, duration_s=0.3),
        duration_s=0.3,
    )
    accurate, fast = simulate(config), simulate(replace(config, integrator="rk"))
    assert np.abs(accurate["state"][:, :4] - fast["state"][:, :4]).max() < 1e-5


@pytest.mark.parametrize("t", [0.11, 0.37, 0.49])
def test_reference_derivatives_are_those_of_the_position(t: float) -> None:
    h = 1e-4
    for reference in (Reference("sine", 0.5, 0.7, offset=0.2, fade_s=0.5), Reference("move", 1.0, duration_s=0.5)):
        values = np.array([link_reference(reference, t + i * h) for i in (-1, 1)])
        slopes = (values[1] - values[0])[:4] / (2 * h)
        assert np.allclose(slopes, link_reference(reference, t)[1:], rtol=1e-4, atol=1e-3)


def test_a_rest_to_rest_move_has_four_continuous_derivatives_at_both_ends() -> None:
    assert np.abs(smoothstep(1e-7, 1.0)[:5]).max() < 0.01
    assert np.abs(smoothstep(1.0 - 1e-7, 1.0) - [1, 0, 0, 0, 0]).max() < 0.01


def test_a_disturbance_term_is_active_over_whole_periods() -> None:
    term = Term(2.0, start_s=0.0104, end_s=0.0130)
    active = [disturbance_over_period((term,), k * T)(k * T) for k in range(16)]
    assert np.flatnonzero(active).tolist() == [11, 12]


def test_the_speed_limit_holds_only_while_the_torque_drives() -> None:
    limits = Limits(peak_torque=74.0, stall_torque=327.0, no_load_speed=3.34)
    assert limited(limits, 80.0, 3.0) == pytest.approx(327.0 * (1 - 3.0 / 3.34))
    assert limited(limits, -80.0, 3.0) == -74.0
    assert limited(limits, 80.0, 4.0) == 0.0
