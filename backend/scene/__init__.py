"""The 3D scene of the actuator: drawn by viser in a process of its own, shown through the web process."""
