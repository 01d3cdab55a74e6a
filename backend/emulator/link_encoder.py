"""The emulated link encoder: a CiA 406 node that latches the link's position at SYNC."""

from backend.emulator.drive_objects import LINK_COUNTS, encoder_objects
from backend.emulator.encoder import WRAP, Encoder
from backend.emulator.network import EmulatedNetwork
from backend.emulator.node import EmulatedNode
from backend.emulator.plant import LINK, EmulatedPlant


class EmulatedLinkEncoder(EmulatedNode):
    """An absolute encoder at the link."""

    def __init__(self, number: int, plant: EmulatedPlant, network: EmulatedNetwork) -> None:
        self.plant, self.encoder = plant, Encoder(LINK_COUNTS)
        super().__init__(number, encoder_objects(number), network)

    def latch(self) -> None:
        """Put the position of now into the dictionary."""
        self.values[0x6004, 0] = self.encoder.counts(self.plant.position(LINK)) % WRAP
