"""The state one sample ahead, by the controller's own model: what removes one sample of compute delay from the loop.

The torque that is applied over the coming sample is known, so the law can act on the state in which its own torque will
meet the plant. One Runge-Kutta step of order 4; the disturbances go on as the estimates d, d', d'' say.
"""

from vssea_core.actuator.spring import leaf
from vssea_core.compiled import inlined
from vssea_core.control.observer import Channel, Memory


@inlined
def accelerations(law, memory, stiffness_acceleration, torque, time, theta_l, omega_l, theta_e, omega_e):
    """Return theta_l'' and theta_e'' [rad/s^2] at `time` [s] after the tick, Eq. (1) with the estimated disturbances."""
    link, motor, stiffness = memory.link, memory.motor, memory.stiffness
    theta_ms = stiffness.measured + time * (stiffness.omega + 0.5 * time * stiffness_acceleration)
    tau_s = law.spring_constant * leaf(theta_e - theta_l, theta_ms).torque
    d_l = link.d + time * (link.d1 + 0.5 * time * link.d2)
    d_e = motor.d + time * (motor.d1 + 0.5 * time * motor.d2)
    a_l = (tau_s - law.link_damping * omega_l) * (1.0 / law.link_inertia) - d_l
    a_e = (torque - tau_s - law.motor_damping * omega_e) * (1.0 / law.motor_inertia) - d_e
    return a_l, a_e


@inlined
def ahead(channel, position, velocity, time):
    """Return the Channel `time` [s] later: position and velocity as given, the disturbance along its own derivatives."""
    d1 = channel.d1 + time * channel.d2
    return Channel(
        position, velocity, channel.d + time * (channel.d1 + 0.5 * time * channel.d2), d1, channel.d2, position
    )


@inlined
def predicted(law, memory, torque, stiffness_acceleration):
    """Return the Memory one sample after this tick, with the motor torque [N m] that is applied until then.

    `stiffness_acceleration` is theta_ms'' [rad/s^2] of the stiffness reference.
    """
    t = law.period
    h = 0.5 * t
    ms_rate = stiffness_acceleration
    x1, v1 = memory.link.theta, memory.link.omega
    y1, w1 = memory.motor.theta, memory.motor.omega
    a1, b1 = accelerations(law, memory, ms_rate, torque, 0.0, x1, v1, y1, w1)
    v2, w2 = v1 + h * a1, w1 + h * b1
    a2, b2 = accelerations(law, memory, ms_rate, torque, h, x1 + h * v1, v2, y1 + h * w1, w2)
    v3, w3 = v1 + h * a2, w1 + h * b2
    a3, b3 = accelerations(law, memory, ms_rate, torque, h, x1 + h * v2, v3, y1 + h * w2, w3)
    v4, w4 = v1 + t * a3, w1 + t * b3
    a4, b4 = accelerations(law, memory, ms_rate, torque, t, x1 + t * v3, v4, y1 + t * w3, w4)
    link = ahead(
        memory.link,
        x1 + t / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4),
        v1 + t / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4),
        t,
    )
    motor = ahead(
        memory.motor,
        y1 + t / 6.0 * (w1 + 2.0 * w2 + 2.0 * w3 + w4),
        w1 + t / 6.0 * (b1 + 2.0 * b2 + 2.0 * b3 + b4),
        t,
    )
    was = memory.stiffness
    moved = t * (was.omega + h * stiffness_acceleration)
    stiffness = Channel(
        was.theta + moved, was.omega + t * stiffness_acceleration, was.d, was.d1, was.d2, was.measured + moved
    )
    return Memory(link, motor, stiffness, memory.spring, memory.twisting)
