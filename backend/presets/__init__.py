"""Named tunings and the last one, kept over restarts."""
