"""What a run recorded: columns by channel name."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vssea_core.channels import INDEX


@dataclass(frozen=True)
class Trajectory:
    """Recorded samples: `rows` is (samples, channels) in the order of channels.CHANNELS, `period_s` apart."""

    rows: NDArray[np.float64]
    period_s: float
    ending: str | None = None

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """Return one channel (samples,). Raises KeyError naming the known channels."""
        try:
            return self.rows[:, INDEX[name]]
        except KeyError:
            raise KeyError(f"no channel {name!r}; known: {', '.join(INDEX)}") from None

    def __len__(self) -> int:
        return len(self.rows)
