"""Worker processes: everything that calculates or encodes much."""
