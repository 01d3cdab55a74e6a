"""The control law: disturbance observers (20)-(24), error state and torque map (6)-(10), both controllers, stiffness loop (19).

One tick is `observer.observe`, with the torques that were applied over the period that has just ended, then `law.act`. Both
are compiled into whatever runs them: a simulation, or one sample of a live session.
"""
