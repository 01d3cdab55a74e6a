"""The simulated rig over one sample period: plant and drives, and what its encoders say."""

from numba.np.unsafe.ndarray import to_fixed_tuple

from vssea_core.actuator.dynamics import PlantState, advance_plant
from vssea_core.actuator.parts import DELAY_LINE, advance_in_parts, lags_of_parts, passed_on
from vssea_core.actuator.sensors import measure
from vssea_core.compiled import entry, inlined
from vssea_core.signals.disturbances import only_constants_and_sines
from vssea_core.simulation.state import PLANT, loaded_rig

PERIOD_STATE = PLANT + DELAY_LINE
"""Numbers of the state of `pass_period`: the PlantState and the torques on their way through the drive."""


@inlined
def needs_parts(rig, link_terms, motor_terms, stiffness_terms):
    """Return whether a period has to be split: a late torque, or a disturbance other than constants and sines."""
    plain = only_constants_and_sines(link_terms) and only_constants_and_sines(motor_terms) and len(stiffness_terms) == 0
    return rig.delay.samples + rig.delay.share != 0.0 or not plain


@entry
def read_encoders(rig_row, state, sample):
    """Return the positions [rad] of link, motor and stiffness motor as the encoders give them at a sample."""
    rig = loaded_rig(rig_row)
    y = measure(rig.encoders, rig.noise, PlantState(*to_fixed_tuple(state[:PLANT], PLANT)), sample)
    return y.theta_l, y.theta_e, y.theta_ms


@entry
def pass_period(rig_row, state, tau_e, tau_ms, link_terms, motor_terms, stiffness_terms, sample):
    """Advance `state` (PERIOD_STATE) in place over the period of a sample, with the torques [N m] that the drives hold."""
    rig = loaded_rig(rig_row)
    in_parts = needs_parts(rig, link_terms, motor_terms, stiffness_terms)
    part_lags = (rig.lags[0], rig.lags[0])
    if in_parts:
        part_lags = lags_of_parts(rig.plant, rig.torque_lag_s, rig.delay.share, rig.sample_time_s)
    now = PlantState(*to_fixed_tuple(state[:PLANT], PLANT))
    period, time = rig.sample_time_s, sample * rig.sample_time_s
    if in_parts:
        older, newer = passed_on(rig.delay, state[PLANT:], tau_e)
        following, _ = advance_in_parts(
            rig.plant, rig.torque_lag_s, part_lags, now, older, newer, rig.delay.share, tau_ms,
            link_terms, motor_terms, stiffness_terms, time, period,
        )  # fmt: skip
    else:
        following, _ = advance_plant(rig.plant, rig.lags, now, tau_e, tau_ms, link_terms, motor_terms, time, period)
    for i in range(PLANT):
        state[i] = following[i]
