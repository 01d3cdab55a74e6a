"""The control process: clock, engine, commands. It owns the rig and all mutable state of a session."""
