"""What the link meets: a weight that hangs on it and walls, torques [N m] that depend on its position and velocity.

Signs as in Eq. (1): positive opposes positive motion.
"""

import math

from vssea_core.compiled import called, entry, inlined
from vssea_core.signals.disturbances import CONTACT, PENDULUM, active

CONTACT_RATE_A_STEP = 0.2
"""Largest rate of a wall times step: keeps the order-5 step within 1e-8 of the penetration."""


@inlined
def penetration(rows, i, theta_l):
    """Return how deep [rad] the link is in wall `i`; negative outside."""
    return rows[i, 6] * (theta_l - rows[i, 3])


@called
def met_load(rows, tick_time, theta_l, omega_l):
    """Return the torque [N m] of weights and walls that are active in the period starting at `tick_time` [s]."""
    total = 0.0
    for i in range(rows.shape[0]):
        if rows[i, 0] >= PENDULUM and active(rows, i, tick_time):
            if rows[i, 0] == PENDULUM:
                total += rows[i, 1] * math.sin(theta_l)
            else:
                depth = penetration(rows, i, theta_l)
                if depth > 0.0:
                    total += rows[i, 6] * max(0.0, rows[i, 1] * depth + rows[i, 2] * rows[i, 6] * omega_l)
    return total


@entry
def met_load_at_rest(rows, time, theta_l):
    """Return the torque [N m] of weights and walls at a tick at `time` [s] on a link that rests at `theta_l` [rad]."""
    return met_load(rows, time, theta_l, 0.0)


@called
def contact_steps(rows, tick_time, per_inertia, theta_l, omega_l, force, length):
    """Return the steps that the walls ask for over `length` [s]: 1 if none can be reached from here.

    `force` bounds the other torques [N m] on the link; twice the distance it could go with them counts as within reach.
    """
    reach = 2.0 * length * (abs(omega_l) + force * per_inertia * length)
    stiffness = damping = 0.0
    for i in range(rows.shape[0]):
        if rows[i, 0] == CONTACT and active(rows, i, tick_time) and penetration(rows, i, theta_l) > -reach:
            stiffness += rows[i, 1]
            damping += rows[i, 2]
    rate = math.sqrt(stiffness * per_inertia) + damping * per_inertia
    return max(1, math.ceil(rate * length / CONTACT_RATE_A_STEP))


@called
def touches(rows, tick_time, before, after):
    """Return whether the link gets into a wall on its way from `before` to `after` [rad]."""
    found = False
    for i in range(rows.shape[0]):
        if rows[i, 0] == CONTACT and active(rows, i, tick_time):
            found = found or (penetration(rows, i, before) < 0.0 < penetration(rows, i, after))
    return found
