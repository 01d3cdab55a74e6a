"""Recorded samples on their way: shared-memory ring, binary frames."""
