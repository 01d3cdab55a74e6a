"""The tick: from a measurement to torques, the same in simulation and on a rig, and the rig's limits behind it."""
