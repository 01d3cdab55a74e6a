"""The closed loop over time: scenario in, trajectory and metrics out."""
