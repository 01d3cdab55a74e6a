"""Linear quadratic regulators of the link's chain and of Eq. (5), by spectral factors.

With one input, Delta(s) Delta(-s) = a(s) a(-s) + sum_i (q_i / r) n_i(s) n_i(-s), where n_i / a leads from the input to the
weighted state: the closed-loop polynomial Delta keeps the roots in the left half-plane. Even in s, so one solves in s^2.
"""

import numpy as np
from numpy.typing import NDArray

from vssea_core.control.design import Numbers, chain_gains_of_poles, plant_gains
from vssea_core.control.linear_model import LinearModel, plant_polynomial

Weights = tuple[float, float, float, float] | NDArray[np.float64]

FAR_APART = 3.0
"""Decades between two squared poles above which the smaller is taken from the reversed polynomial."""
TINY = 1e-300


def lqr_chain_gains(weights: Weights, snap_weight: float) -> Numbers:
    """Return K (4) that minimises the integral of sum q_i e_i^2 + r nu^2 on the chain e' = Gamma e - b nu.

    `weights` are q (4,) on [e1, e2, e3, e4], `snap_weight` is r on the snap nu. Raises ValueError unless q1 > 0, the other
    q >= 0 and r > 0.
    """
    return chain_gains_of_poles(lqr_chain_poles(weights, snap_weight))


def lqr_plant_gains(model: LinearModel, weights: Weights, torque_weight: float) -> Numbers:
    """Return Kx (4) of u = -Kx x that minimises the integral of sum q_i x_i^2 + r u^2 on Eq. (5).

    `weights` are q (4,) on x = [theta_l, theta_l', theta_e, theta_e'], `torque_weight` is r on the torque. Raises ValueError
    unless q of a position is > 0, all are >= 0 and r > 0.
    """
    return plant_gains(model, chain_gains_of_poles(lqr_plant_poles(model, weights, torque_weight)))


def lqr_chain_poles(weights: Weights, snap_weight: float) -> NDArray[np.complex128]:
    """Return the four closed-loop poles [rad/s] of `lqr_chain_gains`: s^8 + sum (q_i / r) (-s^2)^(i-1) = 0."""
    _check(weights, snap_weight, positions=(0,))
    signs = np.array([1.0, -1.0, 1.0, -1.0])
    return _stable_factor(np.array([*(np.asarray(weights, dtype=float) / snap_weight * signs), 1.0]))


def lqr_plant_poles(model: LinearModel, weights: Weights, torque_weight: float) -> NDArray[np.complex128]:
    """Return the four closed-loop poles [rad/s] of `lqr_plant_gains`; their chain K has the same undisturbed response."""
    _check(weights, torque_weight, positions=(0, 2))
    a0, a1, a2, a3 = plant_polynomial(model)
    inertia, damping = model.link_inertia / model.stiffness, model.link_damping / model.stiffness
    q1, q2, q3, q4 = weights
    motor_per_link = [1.0, 2.0 * inertia - damping**2, inertia**2]  # |J_l s^2 + b_l s + k|^2 / k^2, in powers of s^2
    cost = np.array([q1, -q2, 0.0, 0.0, 0.0])
    cost[:4] += np.convolve([q3, -q4], motor_per_link)
    open_loop = [a0 * a0, 2.0 * a0 * a2 - a1 * a1, a2 * a2 + 2.0 * a0 - 2.0 * a1 * a3, 2.0 * a2 - a3 * a3, 1.0]
    return _stable_factor(open_loop + cost / (torque_weight * model.torque_per_snap**2))


def _stable_factor(coefficients: Numbers) -> NDArray[np.complex128]:
    """Return the left half-plane roots s (4,) of f(s^2) = 0, for f of degree four, lowest power first, and f(0) > 0.

    Scaled by the mean radius; where roots lie far apart the small ones are taken from the reversed polynomial, in which they
    are large.
    """
    radius = float(coefficients[0] / coefficients[4]) ** 0.125
    scaled = coefficients / coefficients[4] / radius ** np.arange(8.0, -1.0, -2.0)
    large, inverses = _largest_first(scaled[::-1]), _largest_first(scaled)
    decades = np.log10(np.maximum(np.abs(large), TINY))
    gaps = decades[:3] - decades[1:]
    count = 1 + int(np.argmax(gaps)) if gaps.max() > FAR_APART else 4
    squares = np.concatenate([large[:count], 1.0 / inverses[: 4 - count]])
    poles: NDArray[np.complex128] = -radius * np.sqrt(squares)
    return poles


def _largest_first(coefficients: Numbers) -> NDArray[np.complex128]:
    roots = np.roots(coefficients).astype(complex)
    return roots[np.argsort(-np.abs(roots), kind="stable")]


def _check(weights: Weights, input_weight: float, positions: tuple[int, ...]) -> None:
    if min(weights) < 0.0 or not sum(weights[i] for i in positions) > 0.0:
        raise ValueError(
            f"the weights are {[float(q) for q in weights]}; expected none below 0 and that of a position above 0, "
            "or the loop would not come back"
        )
    if not input_weight > 0.0:
        raise ValueError(
            f"the weight of the input is {input_weight:g}; expected more than 0, or the gains have no bound"
        )
