"""Measurements on an emulated rig: the whole chain of page, server, control process, CAN frames and plant."""
