"""Entry of a rig's control process whose rigs are simulated; started by name in a process of its own."""

from multiprocessing.connection import Connection

from backend.loop import rig_process
from backend.rigs.simulated import SimulatedRig


def run(ring_name: str, flag_name: str, beats_name: str, epoch: int, pipe: Connection) -> None:
    """Turn the loop of a rig, as the product does."""
    rig_process.rig_of = lambda file, scenario: SimulatedRig(scenario, 40.0)  # type: ignore[assignment]
    rig_process.run_rig_process(ring_name, flag_name, beats_name, epoch, pipe)
