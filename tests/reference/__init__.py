"""Independent reference implementation of plant, observers, control law and sampled-data matrix.

Written from the equations alone, it imports nothing of the code it is compared with. All quantities are gear side, SI
units, radians. Slow on purpose: matrix exponentials and an adaptive integrator instead of closed forms and fixed steps.
"""
