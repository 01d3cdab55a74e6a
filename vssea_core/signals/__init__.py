"""References and disturbances as functions of time."""
