"""A controller written from controller.json alone, with numpy: nothing of the project is imported."""

import math
from typing import Any

import numpy as np

Numbers = np.ndarray[Any, np.dtype[np.float64]]
CHANNELS = ("link", "motor", "stiffness")


class JsonController:
    """Follows `order_of_tick` of the document; `tick` returns what was asked of both motors and the terms."""

    def __init__(self, document: dict[str, Any]) -> None:
        self.document, self.model, self.period = document, document["model"], document["timing"]["T"]
        self.started, self.twisting, self.asked_twisting = False, 0.0, 0.0

    def spring(self, deflection: float, theta_ms: float) -> tuple[float, float, float]:
        constant = self.model["Y_tau"]
        return (
            constant * math.sin(deflection / 2) / theta_ms**3,
            constant * math.cos(deflection / 2) / (2 * theta_ms**3),
            -12 * constant * math.sin(deflection / 4) ** 2 / theta_ms**4,
        )

    def at_stiffness(self, table: list[Any], theta_ms: float) -> Numbers:
        rows, gains = np.array(table), self.document["gains"]
        if len(rows) == 1:
            first: Numbers = rows[0]
            return first
        rounded = round(theta_ms * 1024) / 1024
        k = self.model["Y_tau"] / (2 * rounded**3)
        place = (math.log(k) - gains["ln_k_first"]) * gains["rows_per_ln_k"]
        place = min(max(place, 0.0), len(rows) - 1.0)
        near = np.arange(4) + min(max(int(place) - 1, 0), len(rows) - 4)
        weights = [math.prod((place - j) / (i - j) for j in near if j != i) for i in near]
        interpolated: Numbers = np.tensordot(weights, rows[near], 1)
        return interpolated

    def forces(self, tau_s: float, back: float, torques: Numbers) -> tuple[float, float, float]:
        m = self.model
        return tau_s * (1 / m["J_l"]), (torques[0] - tau_s) * (1 / m["J_e"]), (torques[1] - back) * (1 / m["J_ms"])

    def tick(self, x: Numbers) -> tuple[float, float]:
        """`x`: positions (3), velocities (3), applied torques (2), torque on its way, limited, references now and ahead."""
        theta, omega, torques = x[:3], x[3:6], x[6:8]
        at = self.theta[2] if self.started else x[20]
        tau_s, _, back = self.spring(theta[1] - theta[0], theta[2])
        if not x[9]:
            self.twisting = self.asked_twisting
        phi = self.forces(tau_s, back, torques)
        if not self.started:
            self.states = [np.array([position, 0.0, f, 0.0, 0.0]) for position, f in zip(theta, phi, strict=True)]
            if self.document["observer"]["form"] == "off":
                self.states[0][2] = self.states[1][2] = 0.0
            self.started = True
        else:
            before = self.forces(*self.last, torques)
            for i, name in enumerate(CHANNELS):
                self.states[i] = self.observed(
                    name, at, self.states[i], (self.theta[i], theta[i]), omega[i], before[i], phi[i]
                )
        self.theta, self.last = theta.copy(), (tau_s, back)
        states, theta_ms, r, ms = [s.copy() for s in self.states], theta[2], x[10:15], x[20:23]
        if self.document["timing"]["predict"]:
            states, theta_ms, r, ms = *self.ahead(x[8], ms[2]), x[15:20], x[23:26]
        return self.law(at, states, theta_ms, r, ms, back)

    def observed(
        self, name: str, at: float, s: Numbers, theta: tuple[float, float], omega: float, phi0: float, phi1: float
    ) -> Numbers:
        observer = self.document["observer"]
        matrices = {part: self.at_stiffness(table, at) for part, table in observer.get(name, {}).items()}
        if observer["form"] == "position":
            guess = matrices["A"] @ s + matrices["B0"] * phi0 + matrices["B1"] * phi1
            corrected: Numbers = guess + matrices["M"] * (theta[1] - guess[0])
            return corrected
        if observer["velocity_source"] == "difference":
            omega = observer["keep"] * s[1] + observer["gain"] * (theta[1] - theta[0])
        damping, inertia = {"link": ("b_l", "J_l"), "motor": ("b_e", "J_e"), "stiffness": ("b_ms", "J_ms")}[name]
        rate = self.model[damping] / self.model[inertia]
        f0, f1 = phi0 - rate * s[1], phi1 - rate * omega
        d = np.zeros(3)
        if matrices:
            d = matrices["A"] @ s[2:] + matrices["h"] * (omega - s[1]) + matrices["b0"] * f0 + matrices["b1"] * f1
        return np.array([theta[1], omega, *d])

    def ahead(self, torque: float, ms_acceleration: float) -> tuple[list[Numbers], float]:
        m, t, (link, motor, ms) = self.model, self.period, self.states

        def rates(y: Numbers, time: float) -> Numbers:
            theta_ms = self.theta[2] + time * ms[1] + time**2 / 2 * ms_acceleration
            tau_s = self.spring(y[2] - y[0], theta_ms)[0]
            d_l, d_e = (s[2] + s[3] * time + s[4] * time**2 / 2 for s in (link, motor))
            a_l = (tau_s - m["b_l"] * y[1]) * (1 / m["J_l"]) - d_l
            return np.array([y[1], a_l, y[3], (torque - tau_s - m["b_e"] * y[3]) * (1 / m["J_e"]) - d_e])

        y = np.array([link[0], link[1], motor[0], motor[1]])
        k1 = rates(y, 0.0)
        k2 = rates(y + t / 2 * k1, t / 2)
        k3 = rates(y + t / 2 * k2, t / 2)
        k4 = rates(y + t * k3, t)
        y = y + t / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        moved = t * ms[1] + t**2 / 2 * ms_acceleration
        following = [
            np.array([*place, s[2] + t * s[3] + t**2 / 2 * s[4], s[3] + t * s[4], s[4]])
            for place, s in ((y[:2], link), (y[2:], motor))
        ]
        return [*following, np.array([ms[0] + moved, ms[1] + t * ms_acceleration, *ms[2:]])], self.theta[2] + moved

    def law(
        self, at: float, states: list[Numbers], theta_ms: float, r: Numbers, ms: Numbers, back: float
    ) -> tuple[float, float]:
        m, (link, motor, stiff) = self.model, states
        gains = {
            name: self.at_stiffness(self.document["gains"][name], at)
            for name in ("K", "S", "Kx", "N_r")
            if name in self.document["gains"]
        }
        tau_s, k, _ = self.spring(motor[0] - link[0], theta_ms)
        loop = self.document["stiffness_loop"]
        known = loop["rate_share"] * stiff[1] / theta_ms
        v, a_ms = loop["moving_share"] * stiff[1] / theta_ms, loop["moving_share"] * ms[2] / theta_ms
        rate = motor[1] - link[1]
        beta = m["b_l"] * (1 / m["J_l"])
        a_l = tau_s * (1 / m["J_l"]) - beta * link[1] - link[2]
        j_l = (k * rate - 3 * tau_s * known) * (1 / m["J_l"]) - beta * a_l - link[3]
        e = r[:4] - [link[0], link[1], a_l, j_l]
        self.asked_twisting = 0.0
        if self.document["controller"] == "state_feedback":
            snap = r[4] + gains["K"] @ e
        elif self.document["controller"] == "sliding_mode":
            sigma = gains["S"] @ e[:3] + e[3]
            snap = r[4] + gains["S"] @ e[1:] + self.pull(sigma)
        else:
            snap = 0.0
        moving = -tau_s * rate**2 / 4 - 6 * k * rate * v + 12 * tau_s * v**2 - 3 * tau_s * a_ms
        needed = a_l + (m["J_l"] * (snap + link[4]) + m["b_l"] * j_l - moving) / k
        torque = m["J_e"] * (needed + motor[2]) + tau_s + m["b_e"] * motor[1]
        if self.document["controller"] == "baseline":
            torque = gains["N_r"] * r[0] - gains["Kx"] @ [link[0], link[1], motor[0], motor[1]]
        # Eq. (19), with r'', b_ms r' and what acts back
        holding = m["J_ms"] * (ms[2] + stiff[2]) + m["b_ms"] * ms[1] + back
        return float(torque), float(loop["K_p"] * (ms[0] - stiff[0]) + loop["K_d"] * (ms[1] - stiff[1]) + holding)

    def pull(self, sigma: float) -> float:
        switching = self.document["switching"]
        if switching["switch"] == "layer":
            return float(switching["rho"] * np.clip(sigma / switching["phi"], -1, 1))
        if switching["switch"] == "tanh":
            return float(switching["rho"] * math.tanh(sigma / switching["phi"]))
        if switching["switch"] == "sgn":
            return float(switching["rho"] * np.sign(sigma))
        gain = switching["L"]
        self.asked_twisting = self.twisting + 1.1 * gain * self.period * float(np.sign(sigma))
        return float(1.5 * math.sqrt(gain * abs(sigma)) * np.sign(sigma) + self.twisting)
