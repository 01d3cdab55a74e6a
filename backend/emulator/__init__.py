"""A whole emulated actuator behind a real CAN protocol stack, as a process of its own."""
