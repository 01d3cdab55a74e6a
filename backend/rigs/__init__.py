"""Rigs behind one protocol: simulated, and two CiA 402 drives on a CAN bus. Drivers know no session."""
