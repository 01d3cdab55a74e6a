"""Two CiA 402 drives in cyclic synchronous torque mode and a link encoder on a CAN bus, as a Rig."""

from backend.rigs.canopen.rig import CanopenRig

__all__ = ["CanopenRig"]
