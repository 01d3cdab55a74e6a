"""A client that pushes the motor of the emulator at a port until it is killed: `python armed_client.py PORT`."""

import sys
import time

from backend.rigs.canopen import CanopenRig
from tests.hardware.live_rig import TORQUE, arm_both, rig_file_at


def main() -> None:
    rig = CanopenRig(rig_file_at(int(sys.argv[1])), 100.0)
    rig.connect()
    rig.configure()
    arm_both(rig)
    next_s = time.perf_counter()
    for cycle in range(100_000):
        rig.exchange(TORQUE, 0.1)
        if cycle == 50:
            sys.stdout.write("pushing\n")
            sys.stdout.flush()
        next_s = max(next_s + rig.period_s, time.perf_counter() - rig.period_s)
        time.sleep(max(0.0, next_s - time.perf_counter()))


if __name__ == "__main__":
    main()
