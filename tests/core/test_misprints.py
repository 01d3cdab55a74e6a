"""What the paper prints and what holds: each misprint beside the plant of Eqs. (1)-(5), of which nothing is assumed twice.

The derivatives of the link are taken from Eq. (5) itself; the printed forms are written out here and nowhere else.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.linalg import expm, solve_continuous_lyapunov

from vssea_core.actuator.spring import leaf, stiffness_motor_position
from vssea_core.control.certificate import certificate
from vssea_core.control.design import state_feedback_gains
from vssea_core.control.observer_bounds import transient_constant

JL, BL, JE, BE, K = 0.10, 0.10, 3.17, 4.0, 200.0
Y = 6.2e7
GAINS = state_feedback_gains(20.0, 1.0)
moderate = st.floats(-1.0, 1.0)


class Instant:
    """One instant of Eq. (5): x, torque u, link disturbance with two derivatives, motor disturbance; and what follows."""

    def __init__(self, x: np.ndarray, u: float, link: np.ndarray, motor: float) -> None:
        theta_l, omega_l, theta_e, omega_e = x
        self.u = u
        tau_s, tau_s_rate = K * (theta_e - theta_l), K * (omega_e - omega_l)
        self.a_e = (u - tau_s - BE * omega_e - motor) / JE
        self.a_l = (tau_s - BL * omega_l - link[0]) / JL
        self.j_l = (tau_s_rate - BL * self.a_l - link[1]) / JL
        self.snap = (K * (self.a_e - self.a_l) - BL * self.j_l - link[2]) / JL
        # Pi_2 and Pi_4 as Eq. (6) has them, with the derivatives that Eqs. (7) and (10) need
        self.pi2 = theta_e + (-tau_s + BL * omega_l + link[0]) / JL
        self.pi2_1 = omega_e + (-tau_s_rate + BL * self.a_l + link[1]) / JL
        self.pi2_2 = self.a_e + (-K * (self.a_e - self.a_l) + BL * self.j_l + link[2]) / JL
        self.pi4 = (tau_s + BE * omega_e + motor) / JE
        self.theta_e, self.omega_e = theta_e, omega_e

    def error(self, r: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Return e of Eq. (7) at reference r, r', r'', r'''."""
        return np.array([r[0] - x[0], r[1] - x[1], r[2] - self.theta_e + self.pi2, r[3] - self.omega_e + self.pi2_1])


instants = st.tuples(
    st.lists(moderate, min_size=4, max_size=4),
    st.floats(-30.0, 30.0),
    st.lists(moderate, min_size=3, max_size=3),
    moderate,
)
references = st.lists(moderate, min_size=5, max_size=5)


def instant(given_values: tuple) -> tuple[np.ndarray, Instant]:
    x, u, link, motor = given_values
    return np.array(x), Instant(np.array(x), u, np.array(link), motor)


def test_eq_3_means_the_deflection_not_the_links_angle() -> None:
    """Eq. (5) linearises k (theta_e - theta_l): turned as a whole, the spring is unloaded; sin(theta_l / 2) is not."""
    theta_ms = stiffness_motor_position(K, Y)
    turned = 0.5
    assert Y * leaf(turned - turned, theta_ms).torque == 0.0
    assert Y / theta_ms**3 * np.sin(turned / 2.0) > 50.0  # as printed: 99 N m at rest


@given(deflection=st.floats(-2.0, 2.0))
@settings(deadline=None)
def test_eq_4_is_the_slope_of_eq_3_with_half_its_constant(deflection: float) -> None:
    theta_ms, h = stiffness_motor_position(K, Y), 1e-4
    slope = Y * (leaf(deflection + h, theta_ms).torque - leaf(deflection - h, theta_ms).torque) / (2.0 * h)
    assert Y * leaf(deflection, theta_ms).stiffness == pytest.approx(slope, rel=1e-7)
    assert Y / 2.0 / theta_ms**3 * np.cos(deflection / 2.0) == pytest.approx(slope, rel=1e-7)


@given(values=instants, r=references)
@settings(deadline=None, max_examples=50)
def test_eq_10_leaves_the_links_own_acceleration_and_jerk(values: tuple, r: list[float]) -> None:
    x, now = instant(values)
    error = now.error(np.array(r), x)
    assert error[2] == pytest.approx(r[2] - now.a_l, abs=1e-8)
    assert error[3] == pytest.approx(r[3] - now.j_l, abs=1e-6)


@given(values=instants, r=references)
@settings(deadline=None, max_examples=50)
def test_eq_7_needs_two_dots_on_pi_2_a_plus_and_the_references_snap(values: tuple, r: list[float]) -> None:
    _, now = instant(values)
    e4_rate = r[4] - now.snap
    assert r[4] - now.u / JE + now.pi2_2 + now.pi4 == pytest.approx(e4_rate, rel=1e-9, abs=1e-6)
    assert (
        now.pi2_2 != pytest.approx(now.pi2_1, rel=1e-3) or abs(now.pi2_2) < 1.0
    )  # one dot, as after (9), is another signal


@given(values=instants, r=references)
@settings(deadline=None, max_examples=50)
def test_eq_9_with_a_plus_gives_the_chosen_poles_and_with_the_printed_minus_does_not(
    values: tuple, r: list[float]
) -> None:
    """The loop is algebraic: Pi_2'' holds u. Solved for u, e4' = -K e; with the minus twice the disturbance is left."""
    x, now = instant(values)
    error = now.error(np.array(r), x)
    through = 1.0 - K / JL  # d(Pi_2'')/d(u / J_e)
    rest = now.pi2_2 + now.pi4 - through * now.u / JE  # what of Pi_2'' + Pi_4 does not hold u

    def e4_rate_with(u: float) -> float:
        return float(r[4] - u / JE + rest + through * u / JE)

    sound = JE * (GAINS @ error + r[4] + rest) / (1.0 - through)
    assert e4_rate_with(sound) == pytest.approx(-GAINS @ error, rel=1e-9, abs=1e-5)
    printed = JE * (GAINS @ error - rest) / (1.0 + through)
    wrong = e4_rate_with(printed) + GAINS @ error
    assert abs(wrong) > 1e-3 * abs(rest) or abs(rest) < 1.0


def test_the_previous_samples_torque_cannot_stand_for_the_present_one() -> None:
    """u[n+1] = c + (1 - k/J_l) u[n]: a factor of -1999 a sample at k 200, so 1e3 N m from 1 mN m in two samples."""
    base = Instant(np.zeros(4), 0.0, np.zeros(3), 0.0)
    pushed = Instant(np.zeros(4), 1.0, np.zeros(3), 0.0)
    factor = JE * (pushed.pi2_2 - base.pi2_2)
    assert factor == pytest.approx(1.0 - K / JL) == pytest.approx(-1999.0)
    assert abs(1e-3 * factor**2) > 1e3


@given(values=instants, r=references)
@settings(deadline=None, max_examples=50)
def test_eq_15_needs_the_references_snap_and_eq_18_a_plus(values: tuple, r: list[float]) -> None:
    x, now = instant(values)
    s = np.array([8000.0, 1200.0, 60.0, 1.0])
    error = now.error(np.array(r), x)
    error_rate = np.array([*error[1:], r[4] - now.snap])
    delta = r[4] + now.pi2_2 + now.pi4 + s[:3] @ error[1:]
    assert s @ error_rate == pytest.approx(-now.u / JE + delta, rel=1e-9, abs=1e-4)
    # With the torque of (16), u = J_e (rho sgn sigma + delta^): sigma' = -rho sgn sigma + (delta - delta^), not minus it.
    rho, sigma, estimate = 500.0, s @ error, 0.9 * delta
    with_law = -(rho * np.sign(sigma) + estimate) + delta
    assert with_law == pytest.approx(-rho * np.sign(sigma) + (delta - estimate), rel=1e-12, abs=1e-9)


def test_eq_13_without_its_square_root_is_no_bound() -> None:
    """V falls outside the printed radius; the state may still grow there, by sqrt(lmax/lmin), before V is back."""
    found = certificate(GAINS, 1.0)
    closed = np.diag(np.ones(3), 1)
    closed[3] = -GAINS / 20.0 ** np.arange(4, 0, -1)  # scaled by p: z' = p A z
    P = solve_continuous_lyapunov(closed.T, -np.eye(4))
    values, vectors = np.linalg.eigh(P)
    start = vectors[:, -1] / np.sqrt(values[-1])  # on V = 1, where it is nearest
    largest = max(float(np.linalg.norm(expm(closed * t) @ start)) for t in np.linspace(0.0, 10.0, 400))
    assert largest > 1.3 * np.linalg.norm(start)
    assert largest <= np.sqrt(values[-1] / values[0]) * np.linalg.norm(start)
    assert found.overshoot == pytest.approx(np.sqrt(values[-1] / values[0]), rel=1e-6)


def test_eq_24_needs_a_constant_before_its_exponential() -> None:
    g, decay = 100.0, 50.0
    observer = np.array([[-3.0 * g, 1.0, 0.0], [-3.0 * g**2, 0.0, 1.0], [-(g**3), 0.0, 0.0]])
    scale = np.diag([1.0, 1.0 / g, 1.0 / g**2])
    worst = max(
        float(np.linalg.norm(scale @ expm(observer * t) @ np.linalg.inv(scale), 2) / np.exp(-decay * t))
        for t in np.linspace(0.0, 0.2, 400)
    )
    assert worst > 2.0
    assert transient_constant([-g, -g, -g], decay) >= 0.99 * worst


def test_eq_19_needs_the_references_acceleration_and_the_motors_damping() -> None:
    """A fast move of the stiffness motor, w 120 rad/s: 0.3 rad off with K_p and K_d alone, on track with all terms."""
    inertia, damping, w = 1e-4, 1e-4, 120.0
    duration, size = 0.4, 80.0

    def reference(t: float) -> tuple[float, float, float]:
        x = np.clip(t / duration, 0.0, 1.0)
        value = x**3 * (10.0 - 15.0 * x + 6.0 * x * x)
        rate = 30.0 * x * x * (1.0 - x) ** 2 / duration
        return size * value, size * rate, size * 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / duration**2

    def largest_error(complete: bool) -> float:
        def motion(t: float, y: np.ndarray) -> list[float]:
            r, r1, r2 = reference(t)
            torque = inertia * (w * w * (r - y[0]) + 2.0 * w * (r1 - y[1]))
            if complete:
                torque += inertia * r2 + damping * y[1]
            return [y[1], (torque - damping * y[1]) / inertia]

        times = np.linspace(0.0, duration, 801)
        run = solve_ivp(motion, (0.0, duration), [0.0, 0.0], t_eval=times, rtol=1e-9, atol=1e-9)
        return float(np.abs(run.y[0] - [reference(t)[0] for t in times]).max())

    assert largest_error(complete=False) > 0.1
    assert largest_error(complete=True) < 1e-6


def test_eq_22_with_the_velocity_held_to_zero_order_leaves_the_velocity_in_the_estimate() -> None:
    """A steady motion without disturbance: d^ has to be 0, whatever the speed changes by; holding v leaves g0 dv."""
    g, t = 200.0, 1e-3
    f_matrix = np.array([[-3.0 * g, 1.0, 0.0], [-3.0 * g**2, 0.0, 1.0], [-(g**3), 0.0, 0.0]])
    gains = np.array([3.0 * g, 3.0 * g**2, g**3])
    h = np.array([gains[0] ** 2 - gains[1], gains[1] * gains[0] - gains[2], gains[2] * gains[0]])
    transition = expm(f_matrix * t)
    integral = np.linalg.solve(f_matrix, transition - np.eye(3))
    acceleration, a = 5.0, np.zeros(3)
    for n in range(400):
        velocity = acceleration * n * t
        a = transition @ a + integral @ (gains * acceleration + h * velocity)
    estimate = a[0] - gains[0] * acceleration * 400 * t
    assert abs(estimate) > 0.1 * acceleration
