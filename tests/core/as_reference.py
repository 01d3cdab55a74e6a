"""A scenario in the terms of the independent reference, so that both run the same experiment."""

from collections.abc import Sequence
from math import inf, pi

from tests.reference import parameters as reference
from vssea_core.control.tuning import PositionObserver, SlidingMode, Tuning
from vssea_core.scenario import Scenario
from vssea_core.signals.documents import LinkDisturbance, MoveReference, SineReference, StepReference
from vssea_core.simulation.state import equilibrium_state


def reference_config(scenario: Scenario, **changes: object) -> reference.Config:
    """Return the reference's Config of `scenario`; `changes` override its fields.

    The reference has no thermal limits and no limit of the stiffness reference's slew: a comparison has to stay inside.
    """
    motor = scenario.actuator.motor
    state = equilibrium_state(scenario)
    fields: dict[str, object] = {
        "plant": _plant(scenario),
        "model": reference_model(scenario.tuning),
        "limits": reference.Limits(
            motor.peak_torque, motor.stall_torque, motor.no_load_speed, scenario.actuator.stiffness.peak_torque
        ),
        "encoders": _encoders(scenario),
        "controller": reference_controller(scenario.tuning),
        "reference": _reference(scenario),
        "stiffness": _stiffness(scenario),
        "link_disturbance": _terms(scenario.disturbances.link),
        "motor_disturbance": _terms(scenario.disturbances.motor),
        "stiffness_disturbance": _terms(scenario.disturbances.stiffness_motor),
        "sample_time_s": scenario.timing.sample_time_s,
        "duration_s": scenario.duration_s,
        "delay_samples": scenario.timing.compute_delay_samples,
        "initial_state": tuple(float(value) for value in state[:4]),
        "initial_torque": float(state[6]),
    }
    return reference.Config(**(fields | changes))  # type: ignore[arg-type]


def reference_controller(tuning: Tuning) -> reference.Controller:
    """Return the reference's Controller with the gains, forms and bandwidths of `tuning`."""
    law, observer, loop = tuning.controller, tuning.observer, tuning.stiffness_loop
    fields: dict[str, object] = {
        "observer_bandwidth": observer.bandwidth,
        "stiffness_observer_bandwidth": loop.observer_bandwidth,
        "stiffness_pole": loop.bandwidth,
        "stiffness_damping": loop.damping,
        "stiffness_terms": loop.terms,
    }
    if isinstance(observer, PositionObserver):
        fields |= {"form": "position"}
    else:
        filtered = observer.velocity_source == "difference"
        fields |= {
            "method": observer.discretisation,
            "difference_filter": observer.velocity_filter if filtered else 0.0,
        }
    if isinstance(law, SlidingMode):
        layer = law.layer_width if law.switch == "layer" else 0.0
        fields |= {"law": "sliding_mode", "surface_pole": law.surface_pole, "boundary_layer": layer}
        fields |= {"switching_gain": law.switching_gain}
    else:
        fields |= {"pole": law.natural_frequency, "damping": law.damping}
    return reference.Controller(**fields)  # type: ignore[arg-type]


def reference_model(tuning: Tuning) -> reference.Plant:
    """Return the plant that the controller of `tuning` believes in."""
    model = tuning.model
    return reference.Plant(
        link_inertia=model.link_inertia,
        link_damping=model.link_damping,
        motor_inertia=model.motor_inertia,
        motor_damping=model.motor_damping,
        spring_constant=model.spring_constant,
        stiffness_inertia=model.stiffness_inertia,
        stiffness_damping=model.stiffness_damping,
    )


def _plant(scenario: Scenario) -> reference.Plant:
    link, motor, mechanism = scenario.actuator.link, scenario.actuator.motor, scenario.actuator.stiffness
    return reference.Plant(
        link.inertia,
        link.damping,
        motor.inertia,
        motor.damping,
        motor.coulomb_friction,
        motor.friction_velocity,
        mechanism.spring_constant,
        mechanism.inertia,
        mechanism.damping,
        motor.torque_lag_s,
        back_torque=mechanism.back_torque,
    )


def _encoders(scenario: Scenario) -> reference.Encoders:
    sensors, turn = scenario.sensors, 2.0 * pi
    return reference.Encoders(
        turn / 2**sensors.link_bits if sensors.link_bits else 0.0,
        turn / (sensors.motor_counts * scenario.actuator.motor.gear_ratio) if sensors.motor_counts else 0.0,
        turn / sensors.stiffness_counts if sensors.stiffness_counts else 0.0,
    )


def _reference(scenario: Scenario) -> reference.Reference:
    wanted = scenario.reference
    if isinstance(wanted, SineReference):
        return reference.Reference(
            "sine", wanted.amplitude, wanted.frequency_hz, offset=wanted.offset, fade_s=wanted.fade_in_s
        )
    if not isinstance(wanted, MoveReference | StepReference):
        raise ValueError(f"the reference knows sines, moves and steps only, not a {wanted.kind}")
    if wanted.repeat:
        raise ValueError("the reference knows single moves and steps only; expected repeat=False")
    times = {"start_s": wanted.start_s}
    if isinstance(wanted, MoveReference):
        times["duration_s"] = wanted.duration_s
    return reference.Reference(wanted.kind, wanted.target - wanted.origin, offset=wanted.origin, **times)


def _stiffness(scenario: Scenario) -> reference.StiffnessReference:
    wanted, filtered = scenario.stiffness_reference, scenario.tuning.stiffness_loop.reference_bandwidth
    if wanted.kind == "constant":
        return reference.StiffnessReference(wanted.stiffness, filter_bandwidth=filtered)
    return reference.StiffnessReference(
        wanted.stiffness, wanted.target, wanted.start_s, wanted.duration_s, filter_bandwidth=filtered
    )


def _terms(terms: Sequence[LinkDisturbance]) -> tuple[reference.Term, ...]:
    found = []
    for term in terms:
        span = term.start_s, inf if term.end_s is None else term.end_s
        match term.kind:
            case "constant":
                found.append(reference.Term(term.torque, start_s=span[0], end_s=span[1]))
            case "sine":
                found.append(reference.Term(term.amplitude, term.frequency_hz, term.phase, *span, "sine"))
            case "multisine":
                parts = term.components
                found.extend(reference.Term(p.amplitude, p.frequency_hz, p.phase, *span, "sine") for p in parts)
            case _:
                raise ValueError(f"the reference knows constants and sines only, not a {term.kind}")
    return tuple(found)
