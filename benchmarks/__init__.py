"""Measurements of this project, each run by its name: `python -m benchmarks NAME`."""
