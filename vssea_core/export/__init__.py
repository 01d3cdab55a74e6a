"""The tuned controller for use elsewhere: its numbers, C source, and test vectors of the compiled tick."""
