"""Thousands of runs: what is varied, and the tick in the lanes of the processor's vectors."""
