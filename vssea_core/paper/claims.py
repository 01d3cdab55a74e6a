"""Every sentence of the paper's results as a claim, in order."""

from vssea_core.paper.claim import Claim
from vssea_core.paper.rig_claims import FIG4_CLAIMS, STIFFNESS_CLAIMS
from vssea_core.paper.simulation_claims import SIMULATION_CLAIMS, TUNED_FOR_PERFORMANCE

STATEMENT = (
    "The paper gives no numbers. Parameters, references, disturbances and criteria are ours, and every figure is simulated: "
    "no measurement of a real actuator is shown, not in Fig. 4 either."
)
CLAIMS: tuple[Claim, ...] = (*SIMULATION_CLAIMS, *FIG4_CLAIMS, *STIFFNESS_CLAIMS, TUNED_FOR_PERFORMANCE)
