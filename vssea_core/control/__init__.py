"""The control law: disturbance observers (20)-(24), error state and torque map (6)-(10), both controllers, stiffness loop (19)."""
