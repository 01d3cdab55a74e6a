"""Second-order disturbance observers: Eqs. (20)-(22) in matrix form, exactly sampled, and on measured positions."""

from __future__ import annotations

import numpy as np
from scipy.linalg import expm


def ackermann(a: np.ndarray, c: np.ndarray, roots: np.ndarray) -> np.ndarray:
    """Gain L (n,) that gives a - L c the eigenvalues `roots`, by Ackermann's formula for the dual pair."""
    n = a.shape[0]
    observability = np.vstack([c @ np.linalg.matrix_power(a, i) for i in range(n)])
    polynomial = np.eye(n)
    for root in roots:
        polynomial = polynomial @ (a - root * np.eye(n))
    return polynomial @ np.linalg.solve(observability, np.eye(n)[:, -1])


def first_order_hold(a: np.ndarray, b: np.ndarray, sample_time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(Phi, G0, G1) with x[k+1] = Phi x[k] + G0 w[k+] + G1 w[k+1-] for x' = a x + b w and w linear in between."""
    n, m = b.shape
    block = np.zeros((n + 2 * m, n + 2 * m))
    block[:n, :n] = a
    block[:n, n : n + m] = b
    block[n : n + m, n + m :] = np.eye(m) / sample_time
    exponential = expm(block * sample_time)
    held, ramp = exponential[:n, n : n + m], exponential[:n, n + m :]
    return exponential[:n, :n], held - ramp, ramp


class AuxiliaryObserver:
    """Eqs. (20)-(22) for n states x with x' = A x + forces - D, first-order hold of x and forces.

    With n = 4 and a_i = D^(i) + g_i x this is the 12-state form of the paper; the spring torque is part of `forces`, so
    A holds only kinematics and damping. The gains g_0, g_1, g_2 = 3 g, 3 g^2, g^3 put a triple pole at g.
    """

    def __init__(self, a: np.ndarray, bandwidth: float, sample_time: float) -> None:
        n = a.shape[0]
        g0, g1, g2 = 3.0 * bandwidth, 3.0 * bandwidth**2, bandwidth**3
        one, zero = np.eye(n), np.zeros((n, n))
        lambda_a = np.block([[-g0 * one, one, zero], [-g1 * one, zero, one], [-g2 * one, zero, zero]])
        lambda_x = np.vstack([g0 * (a + g0 * one) - g1 * one, g1 * (a + g0 * one) - g2 * one, g2 * (a + g0 * one)])
        self.gains = np.array([g0, g1, g2])
        lambda_u = np.vstack([g * one for g in self.gains])
        self.phi, self.now, self.next = first_order_hold(lambda_a, np.hstack([lambda_x, lambda_u]), sample_time)
        self.linear = a
        self.auxiliary = np.zeros(3 * n)

    def start(self, x: np.ndarray, forces: np.ndarray) -> None:
        """Begin in equilibrium: D = A x + forces, D' = D'' = 0."""
        d = self.linear @ x + forces
        self.auxiliary = np.concatenate([d + self.gains[0] * x, self.gains[1] * x, self.gains[2] * x])

    def update(self, x: np.ndarray, forces: np.ndarray, x_next: np.ndarray, forces_next: np.ndarray) -> None:
        """One period on: (x, forces) at k+ and at (k+1)-, both with the torque applied over the period."""
        before, after = np.concatenate([x, forces]), np.concatenate([x_next, forces_next])
        self.auxiliary = self.phi @ self.auxiliary + self.now @ before + self.next @ after

    def estimate(self, x: np.ndarray) -> np.ndarray:
        """[D, D', D''] as rows, shape (3, n), at the present measured x."""
        return self.auxiliary.reshape(3, -1) - np.outer(self.gains, x)


class SampledObserver:
    """Exactly sampled velocity observer of one channel: d = T-integral of f - v', a triple discrete pole exp(-g T)."""

    def __init__(self, bandwidth: float, sample_time: float) -> None:
        t = sample_time
        chain = np.diag([1.0, 1.0], 1)
        integrated = np.zeros((4, 4))
        integrated[:3, :3] = chain
        integrated[3, 0] = 1.0
        self.phi, self.c = expm(chain * t), expm(integrated * t)[3, :3]
        self.gain = ackermann(self.phi, self.c, np.full(3, np.exp(-bandwidth * t)))
        self.sample_time = t
        self.d = np.zeros(3)

    def update(self, v: float, f: float, v_next: float, f_next: float) -> None:
        """One period on: velocity [rad/s] and nominal acceleration [rad/s^2] at k+ and (k+1)-."""
        y = v - v_next + self.sample_time * (f + f_next) / 2.0
        self.d = self.phi @ self.d + self.gain * (y - self.c @ self.d)


class PositionObserver:
    """[theta, w, d, d', d''] of one channel: w' = -(b/J) w + phi - d, corrected by the measured position."""

    def __init__(self, damping_rate: float, bandwidth: float, sample_time: float) -> None:
        a = np.diag([1.0, -1.0, 1.0, 1.0], 1)
        a[1, 1] = -damping_rate
        b = np.eye(5)[:, 1:2]
        self.a, now, after = first_order_hold(a, b, sample_time)
        self.now, self.next = now[:, 0], after[:, 0]
        c = np.eye(5)[0]
        self.gain = np.linalg.solve(self.a, ackermann(self.a, c, np.full(5, np.exp(-bandwidth * sample_time))))
        self.x = np.zeros(5)

    def start(self, theta: float, phi: float) -> None:
        """Begin at rest in equilibrium: d = phi."""
        self.x = np.array([theta, 0.0, phi, 0.0, 0.0])

    def update(self, phi: float, theta_next: float, phi_next: float) -> None:
        """One period on: undamped nominal acceleration phi [rad/s^2] at k+ and (k+1)-, measured angle [rad] at k+1."""
        predicted = self.a @ self.x + self.now * phi + self.next * phi_next
        self.x = predicted + self.gain * (theta_next - predicted[0])
