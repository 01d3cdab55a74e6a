"""The linear model of Eq. (5) at one stiffness, its normal form in the link's derivatives, and its sampled form.

In chi = [theta_l, theta_l', theta_l'', theta_l'''] the plant is a chain of four integrators:
theta_l'''' = alpha x + u / kappa, with kappa = J_l J_e / k the torque per unit of snap.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vssea_core.control.matrix_exponential import exponential_less_identity

Numbers = NDArray[np.float64]


class LinearModel(NamedTuple):
    """Link and motor at the gear side, with the spring's stiffness: Eq. (5), units kg m^2, N m s/rad, N m/rad."""

    link_inertia: float
    link_damping: float
    motor_inertia: float
    motor_damping: float
    stiffness: float

    @property
    def torque_per_snap(self) -> float:
        """Return kappa = J_l J_e / k [N m per rad/s^4]."""
        return self.link_inertia * self.motor_inertia / self.stiffness


def state_space(model: LinearModel) -> tuple[Numbers, Numbers, Numbers]:
    """Return A (4, 4), B (4,), C (4,) of Eq. (5): x = [theta_l, theta_l', theta_e, theta_e'], u = motor torque [N m]."""
    jl, bl, je, be, k = model
    a = np.array(
        [
            [0.0, 1.0, 0.0, 0.0],
            [-k / jl, -bl / jl, k / jl, 0.0],
            [0.0, 0.0, 0.0, 1.0],
            [k / je, 0.0, -k / je, -be / je],
        ]
    )
    return a, np.array([0.0, 0.0, 0.0, 1.0 / je]), np.array([1.0, 0.0, 0.0, 0.0])


def plant_polynomial(model: LinearModel) -> Numbers:
    """Return a0..a3 (4,) of det(sI - A) = s^4 + a3 s^3 + a2 s^2 + a1 s + a0, lowest power first; a0 = 0."""
    jl, bl, je, be, k = model
    beta, gamma = bl / jl, be / je
    return np.array([0.0, k * (bl + be) / (jl * je), k / jl + k / je + beta * gamma, beta + gamma])


def normal_form(model: LinearModel) -> tuple[Numbers, Numbers]:
    """Return T (4, 4) and alpha (4,): [theta_l, ..., theta_l'''] = T x and theta_l'''' = alpha x + u / kappa.

    Without disturbances, Eqs. (6)-(8): the error state is [r, r', r'', r'''] - T x.
    """
    w2, beta = model.stiffness / model.link_inertia, model.link_damping / model.link_inertia
    acceleration = np.array([-w2, -beta, w2, 0.0])
    jerk = np.array([0.0, -w2, 0.0, w2]) - beta * acceleration
    transform = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], acceleration, jerk])
    return transform, -plant_polynomial(model) @ transform


def sampled(model: LinearModel, sample_time_s: float) -> tuple[Numbers, Numbers]:
    """Return Phi (4, 4), gam (4,) of x[k+1] = Phi x[k] + gam u[k], exact for a torque held over `sample_time_s`."""
    change, effect = sampled_chain(model, sample_time_s)
    transform, _ = normal_form(model)
    scale = sample_time_s ** np.arange(4.0)
    to_chain = scale[:, None] * transform
    phi = np.eye(4) + np.linalg.solve(to_chain, change @ to_chain)
    effect_on_chain: Numbers = effect * (sample_time_s**4 / model.torque_per_snap)
    return phi, np.asarray(np.linalg.solve(to_chain, effect_on_chain), dtype=np.float64)


def sampled_chain(model: LinearModel, sample_time_s: float) -> tuple[Numbers, Numbers]:
    """Return Phi - I (4, 4) and gam (4,) in z_i = T^i theta_l^(i), for the input T^4 u / kappa held over T.

    All entries are of the order of one, whatever the sample time and the stiffness; nothing cancels in Phi - I.
    """
    block = np.diag(np.ones(4), 1)
    block[3, :4] = -plant_polynomial(model) * sample_time_s ** np.arange(4.0, 0.0, -1.0)
    change = exponential_less_identity(block)
    return change[:4, :4], change[:4, 4]
