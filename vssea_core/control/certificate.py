"""What bounds the error for certain: Lyapunov's ultimate bound (11)-(13), corrected, beside the exact peak gain.

e' = (Gamma - b K^T) e + b w, where w is what the disturbance estimates are wrong by, as link snap. All in scaled states
z_i = e_i / p^(i-1) with p = K1^(1/4): unscaled, Lyapunov's bound is uselessly large.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_continuous_lyapunov

from vssea_core.control.linear_model import LinearModel
from vssea_core.control.peak_gain import peak_gain

Numbers = NDArray[np.float64]


@dataclass(frozen=True)
class Certificate:
    """Bounds on the tracking error while |w| <= `snap_bound`."""

    snap_bound: float
    """D [rad/s^4]: the largest |w|."""
    scale: float
    """p = K1^(1/4) [rad/s] of the scaled states z_i = e_i / p^(i-1)."""
    lyapunov_matrix: Numbers
    """P (4, 4) of A^T P + P A = -I for the scaled states in scaled time p t."""
    lyapunov_bound: float
    """Ultimate bound [rad] on |z|, so on |e1|: sqrt(lmax(P) / lmin(P)) 2 |P b| D / (p^4 lmin(Q))."""
    overshoot: float
    """sqrt(lmax(P) / lmin(P)): |z(t)| <= overshoot * exp(-decay t) |z(0)| without disturbance."""
    decay: float
    """The rate [1/s] in it: p / (2 lmax(P))."""
    peak_gain: float
    """Integral of |h| [s^4] from w to e1; 1/p^4 for the quadruple pole."""
    peak_error: float
    """The exact bound [rad]: |e1| <= peak_gain * D once transients are over; a bounded w comes as close as one likes."""

    @property
    def conservatism(self) -> float:
        """Return how many times the Lyapunov bound is the exact one."""
        return self.lyapunov_bound / (self.peak_error or np.inf) if self.snap_bound else np.nan


def certificate(gains: Numbers, snap_bound: float) -> Certificate:
    """Return the Certificate of the chain's gains K (4) for |w| <= `snap_bound` [rad/s^4].

    Raises ValueError if the gains do not stabilise the chain or the bound is negative.
    """
    if not snap_bound >= 0.0:
        raise ValueError(f"the bound on the snap error is {snap_bound:g} rad/s^4; expected 0 or more")
    p = float(abs(gains[0])) ** 0.25
    closed = np.diag(np.ones(3), 1)
    closed[3] = -np.asarray(gains) / p ** np.arange(4.0, 0.0, -1.0)
    if not np.linalg.eigvals(closed).real.max() < 0.0:
        raise ValueError(
            f"gains {[float(k) for k in gains]} do not stabilise the error; choose poles in the left half-plane"
        )
    matrix: Numbers = np.asarray(solve_continuous_lyapunov(closed.T, -np.eye(4)), dtype=np.float64)
    low, *_, high = np.linalg.eigvalsh(matrix)
    spread = float(np.sqrt(high / low))
    gain = peak_gain(np.array([1.0]), np.asarray(gains))
    return Certificate(
        snap_bound=snap_bound,
        scale=p,
        lyapunov_matrix=matrix,
        lyapunov_bound=spread * 2.0 * float(np.linalg.norm(matrix[:, 3])) * snap_bound / p**4,
        overshoot=spread,
        decay=p / (2.0 * float(high)),
        peak_gain=gain,
        peak_error=gain * snap_bound,
    )


def snap_weights(model: LinearModel, gains: Numbers) -> Numbers:
    """Return the weights (4,) of w on the errors of [d_l, d_l', d_l'', d_e]; the paper's (13) lacks most of them.

    w = (K3 - beta K4 + beta^2 - w2) x0 + (K4 - beta) x1 + x2 + w2 xe, with beta = b_l / J_l and w2 = k / J_l.
    """
    beta, w2 = model.link_damping / model.link_inertia, model.stiffness / model.link_inertia
    _, _, k3, k4 = gains
    return np.array([k3 - beta * k4 + beta**2 - w2, k4 - beta, 1.0, w2])


def snap_bound(model: LinearModel, gains: Numbers, estimation_errors: Numbers) -> float:
    """Return D [rad/s^4] from bounds (4,) on the errors of [d_l, d_l', d_l'', d_e] in rad/s^2, rad/s^3, rad/s^4, rad/s^2."""
    return float(np.abs(snap_weights(model, gains)) @ np.abs(estimation_errors))
