"""The ready scenarios: `nominal` as the paper assumes, `realistic` as a rig with encoders is, `paper_fig2` for the numbers."""

from vssea_core.actuator.parameters import Actuator, EquilibriumMotor, Link, Sensors, StiffnessMechanism, Timing
from vssea_core.control.tuning import ControllerModel, PositionObserver, StateFeedback, Tuning, VelocityObserver
from vssea_core.scenario import Scenario
from vssea_core.signals.documents import ConstantDisturbance, Disturbances, MoveReference, SineDisturbance

_LOAD = Disturbances(
    link=(
        ConstantDisturbance(torque=3.0, start_s=3.0),
        SineDisturbance(amplitude=3.0, frequency_hz=0.5, start_s=3.0),
    )
)

NOMINAL = Scenario(
    name="nominal",
    description="The paper's assumptions: the model is the plant, velocities are measured, nothing lags. "
    "Sine of 0.5 rad, 0.25 Hz; 3 + 3 sin(πt) N·m on the link from 3 s.",
    disturbances=_LOAD,
)

REALISTIC = Scenario(
    name="realistic",
    description="A rig: encoders only, dry friction the model does not know, torque-loop lag, one sample of delay, "
    "position observer. The same reference and load.",
    actuator=Actuator(motor=EquilibriumMotor(coulomb_friction=5.6, torque_lag_s=1.6e-4)),
    sensors=Sensors(link_bits=17, motor_counts=16384, stiffness_counts=16384, velocities=False),
    timing=Timing(compute_delay_samples=1),
    tuning=Tuning(observer=PositionObserver(bandwidth=100.0)),
    disturbances=_LOAD,
)

PAPER_FIG2 = Scenario(
    name="paper_fig2",
    description="The parameter set of the figures: a move of 1 rad in 1 s, from 3 s 3 + 5 sin(πt) + 2 sin(3πt) N·m on the link "
    "and 4 sin(1.4πt) N·m on the motor; poles -8, observer 200 rad/s, 150 N·m.",
    actuator=Actuator(
        link=Link(inertia=0.12, damping=0.25),
        motor=EquilibriumMotor(
            inertia=3.3, damping=6.0, peak_torque=150.0, continuous_torque=150.0, no_load_speed=1000.0, stall_torque=1e5
        ),
        stiffness=StiffnessMechanism(),
    ),
    tuning=Tuning(
        controller=StateFeedback(natural_frequency=8.0),
        observer=VelocityObserver(bandwidth=200.0),
        model=ControllerModel(link_inertia=0.12, link_damping=0.25, motor_inertia=3.3, motor_damping=6.0),
    ),
    reference=MoveReference(target=1.0, duration_s=1.0, repeat=False, start_s=0.0),
    disturbances=Disturbances(
        link=(
            ConstantDisturbance(torque=3.0, start_s=3.0),
            SineDisturbance(amplitude=5.0, frequency_hz=0.5, start_s=3.0),
            SineDisturbance(amplitude=2.0, frequency_hz=1.5, start_s=3.0),
        ),
        motor=(SineDisturbance(amplitude=4.0, frequency_hz=0.7, start_s=3.0),),
    ),
)

SCENARIOS: dict[str, Scenario] = {scenario.name: scenario for scenario in (NOMINAL, REALISTIC, PAPER_FIG2)}
