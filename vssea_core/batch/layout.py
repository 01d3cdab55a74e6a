"""Where the numbers of a lane stand: parameters, state, what comes from outside at a sample, and sums over the run.

The parameters are the very arrays that a single run reads: the simulated rig, the prepared tuning, the slew.
"""

from vssea_core.control.law import GAINS
from vssea_core.control.packing import OBSERVER, ROW, ROWS_AT, STIFFNESS_AT
from vssea_core.signals.stiffness import SLEW_SIZE
from vssea_core.simulation import state
from vssea_core.simulation.state import STATE_SIZE, TIMING_AT

RIG = 0  # up to its timing; timing, delay and noise are the same for all lanes, or none
PREPARED = RIG + TIMING_AT
SLEW = PREPARED + ROWS_AT + ROW
STATE = SLEW + SLEW_SIZE
TARGET = STATE + STATE_SIZE  # what comes from outside at a sample: the reference and four derivatives
AIM = TARGET + 5  # those that the law aims at
COMMAND = AIM + 5  # of the stiffness motor [rad]
LINK_LOADS = COMMAND + 1  # torques at the six instants of a step [N m]
MOTOR_LOADS = LINK_LOADS + 6
STEPS = (
    MOTOR_LOADS + 6
)  # into how many steps the period is divided, which of the rig's lags is theirs, and the torque gap
SUMS = STEPS + 3
TAKEN_AT = SUMS + 17  # stiffness motor position [rad] for which the gains in the lane were taken, where they follow it
GONE = TAKEN_AT + 1  # not 0 once the run cannot go on: it is then run alone, which tells when and why
LANE_SIZE = GONE + 1

LAGS = RIG + state.PLANT_SIZE
DRIVES, ENCODERS = RIG + state.DRIVES_AT, RIG + state.ENCODERS_AT
STIFFNESS_OBSERVER = PREPARED + STIFFNESS_AT
GAINS_ROW = PREPARED + ROWS_AT
LINK_OBSERVER = GAINS_ROW + GAINS
MOTOR_OBSERVER = LINK_OBSERVER + OBSERVER
HEAT, APPLIED, MEMORY, SLEWED = (STATE + place for place in (state.PLANT, state.APPLIED, state.MEMORY, state.SLEWED))
(
    PEAK_ERROR,
    SQUARED_ERROR,
    PEAK_TORQUE,
    SQUARED_TORQUE,
    LAST_TORQUE,
    SQUARED_CHANGE,
    SATURATED,
    LINK_ESTIMATE,
    MOTOR_ESTIMATE,
) = range(9)
LIMITS = 9  # how often each of the eight bits was set
