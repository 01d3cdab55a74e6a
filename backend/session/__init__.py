"""The web side of a live session: commands, events, health, and the link to the control process."""
