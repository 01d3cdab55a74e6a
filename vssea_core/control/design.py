"""Gains from poles: Eqs. (9), (14). `control.place` refuses repeated poles with one input; polynomials do not.

K (4,) are the gains of the chain e' = (Gamma - b K^T) e in units rad/s^4 per rad, rad/s, ...; Kx (4,) those of u = -Kx x on
(A, B) of Eq. (5) in N m per rad, rad/s, ... . Either gives the other: same poles, same undisturbed response.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vssea_core.control.linear_model import LinearModel, normal_form, plant_polynomial, sampled_chain

Numbers = NDArray[np.float64]
Poles = Sequence[complex] | NDArray[np.complex128] | NDArray[np.float64]


def state_feedback_gains(natural_frequency: float, damping: float) -> Numbers:
    """Return K (4) of e' = (Gamma - b K^T) e with the characteristic polynomial (s^2 + 2 zeta p s + p^2)^2.

    At damping 1 this is [p^4, 4 p^3, 6 p^2, 4 p], the quadruple pole -p. Units: rad/s^4 per rad, rad/s, ...
    """
    a, b = 2.0 * damping * natural_frequency, natural_frequency**2
    return np.array([b * b, 2.0 * a * b, a * a + 2.0 * b, 2.0 * a])  # (s^2 + a s + b)^2


def surface_gains(surface_pole: float) -> Numbers:
    """Return s1, s2, s3 of (s + lambda)^3 = s^3 + s3 s^2 + s2 s + s1: the motion on sigma = 0, Eq. (14)."""
    return np.array([surface_pole**3, 3.0 * surface_pole**2, 3.0 * surface_pole])


def polynomial_of(poles: Poles) -> Numbers:
    """Return c (n,) of prod(s - s_i) = s^n + c[n-1] s^(n-1) + ... + c[0], lowest power first, for n poles [rad/s].

    Raises ValueError if a complex pole comes without its conjugate.
    """
    coefficients, sizes = [1.0 + 0.0j], [1.0]  # of a handful of poles: arrays would cost ten times the sums
    for pole in map(complex, poles):
        shifted = zip([*coefficients, 0.0], [0.0, *coefficients], strict=True)
        coefficients = [here - pole * before for here, before in shifted]
        sizes.append(sizes[-1] * abs(pole))
    if any(abs(c.imag) > 1e-6 * max(abs(c), size) for c, size in zip(coefficients, sizes, strict=True)):
        raise ValueError(f"poles {list(poles)} have a complex one without its conjugate; give both of each pair")
    return np.array([c.real for c in reversed(coefficients[1:])])


def chain_gains_of_poles(poles: Poles) -> Numbers:
    """Return K (4) of the chain with the four given closed-loop poles [rad/s].

    Raises ValueError if there are not four, if one is not in the left half-plane, or lacks its conjugate.
    """
    _check_poles(poles)
    return polynomial_of(poles)


def plant_gains(model: LinearModel, chain_gains: Numbers) -> Numbers:
    """Return Kx (4) of u = -Kx x on Eq. (5) with the closed-loop poles of the chain's K: Kx = kappa (K T + alpha)."""
    transform, alpha = normal_form(model)
    return model.torque_per_snap * (np.asarray(chain_gains) @ transform + alpha)


def chain_gains(model: LinearModel, gains_on_plant: Numbers) -> Numbers:
    """Return the chain's K (4) with the closed-loop poles of u = -Kx x on Eq. (5); the inverse of `plant_gains`."""
    transform, alpha = normal_form(model)
    on_chain: Numbers = np.asarray(gains_on_plant) / model.torque_per_snap - alpha
    return np.asarray(np.linalg.solve(transform.T, on_chain), dtype=np.float64)


def prefilter(a: Numbers, b: Numbers, c: Numbers, gains: Numbers) -> float:
    """Return N_r [N m/rad] of u = -K x + N_r r, for which C x settles at r: N_r = -1 / (C (A - B K)^-1 B)."""
    return float(-1.0 / (c @ np.linalg.solve(a - np.outer(b, gains), b)))


def baseline_poles_gains(model: LinearModel, pole: float) -> tuple[Numbers, float]:
    """Return Kx (4) and N_r of the baseline u = -Kx x + N_r r with the quadruple pole -`pole` [rad/s], Fig. 2."""
    gains = state_feedback_gains(pole, 1.0)
    return plant_gains(model, gains), model.torque_per_snap * float(gains[0])


def exact_sampled_gains(model: LinearModel, poles: Poles, sample_time_s: float) -> Numbers:
    """Return the chain's K (4) for which the sampled loop has its poles at exp(s_i T), exactly.

    The law nu = K e goes through the torque map, u = kappa (nu - alpha x), and the torque is held over T: Ackermann's formula
    on the sampled plant, in powers of Phi - I and of exp(s_i T) - 1, so that nothing is lost at short samples.
    Raises ValueError as `chain_gains_of_poles`, and if the plant's resonance is not below the Nyquist frequency.
    """
    _check_poles(poles)
    t = sample_time_s
    polynomial = plant_polynomial(model)
    resonance = float(np.sqrt(polynomial[2]))
    if resonance * t >= np.pi:
        raise ValueError(
            f"the plant's resonance of {resonance:.4g} rad/s is above the Nyquist frequency of {np.pi / t:.4g} rad/s; "
            f"an exact sampled design needs a sample time below {np.pi / resonance:.3g} s"
        )
    change, effect = sampled_chain(model, t)
    wanted = polynomial_of(np.expm1(np.asarray(poles, dtype=complex) * t))
    columns, powers = [effect], [np.eye(4)]
    for _ in range(3):
        columns.append(change @ columns[-1])
        powers.append(change @ powers[-1])
    powers.append(change @ powers[-1])
    value = powers[4] + sum(factor * power for factor, power in zip(wanted, powers, strict=False))
    row = np.linalg.solve(np.array(columns), [0.0, 0.0, 0.0, 1.0])
    scaled: Numbers = row @ value
    return scaled / t ** np.arange(4.0, 0.0, -1.0) + polynomial


def _check_poles(poles: Poles) -> None:
    if len(poles) != 4:
        raise ValueError(f"{len(poles)} poles were given; the error state has four, so give four")
    for pole in poles:
        if not pole.real < 0.0:
            raise ValueError(
                f"pole {pole:.4g} rad/s is not in the left half-plane; give poles with a negative real part"
            )
