"""The science of a variable stiffness series elastic actuator: model, control, simulation and analysis.

Pure: no clock, no files, no network, no logging. Importing this package imports nothing heavy.
"""

__version__ = "0.1.0"
