"""The order of a tick in words, for whoever writes it in another language."""

from vssea_core.control.tuning import Tuning


def order_of_tick(tuning: Tuning, *, predicts: bool) -> list[str]:
    """Return the steps of one tick of `tuning`, formulas in the names of export.numbers."""
    steps = [
        "1. Measure theta_l, theta_e, theta_ms"
        + (", omega_l, omega_e, omega_ms." if _needs_velocities(tuning) else "; no velocities are needed."),
        "2. Gains: row of gains.k; of several rows, through the four nearest (cubic Lagrange, evenly spaced in ln k, ends hold) at "
        "k = Y_tau/(2 theta_ms^3), theta_ms as measured at the last tick (at the first: its reference), rounded to 1/1024 rad.",
        "3. Spring, from measured positions, delta = theta_e - theta_l: tau_s = Y_tau sin(delta/2)/theta_ms^3, "
        "tau_back = -12 Y_tau sin(delta/4)^2/theta_ms^4.",
        "4. First tick only: omega = 0, d' = d'' = 0, and d as in equilibrium: d_l = tau_s/J_l, d_e = (tau_applied - tau_s)/J_e, "
        "d_ms = (tau_ms,applied - tau_back)/J_ms" + (", but d_l = d_e = 0." if tuning.observer.kind == "off" else "."),
        "5. Otherwise observers up to now, with the torques applied over the period that has just ended (after all limits; with a "
        "compute delay, the delayed ones): index 0 with tau_s of the last tick, index 1 with tau_s of this one. "
        + _observers(tuning),
    ]
    if predicts:
        steps.append(
            "6. State one period ahead: one Runge-Kutta step of order 4 of J_l theta_l'' = tau_s - b_l omega_l - J_l d_l(t), "
            "J_e theta_e'' = tau_pending - tau_s - b_e omega_e - J_e d_e(t), with d(t) = d + d' t + d'' t^2/2 and "
            "theta_ms(t) = measured theta_ms + omega_ms t + r_ms'' t^2/2, r_ms'' of now; tau_pending is the torque of the last "
            "tick, after limits. The law below takes that state, d and d' of link and motor one period ahead, the measured "
            "theta_ms moved likewise, and both references one period ahead; d_ms and tau_back stay those of now. Step 5 of the "
            "next tick goes on from the state of now."
        )
    steps += [
        f"{len(steps) + 1}. Law, with tau_s and k = Y_tau cos(delta/2)/(2 theta_ms^3) at the estimated theta_e - theta_l and the "
        "measured theta_ms: " + _law(tuning),
        f"{len(steps) + 2}. Stiffness motor: tau_ms = J_ms (r'' + w2 (r - theta_ms) + two_zeta_w (r' - omega_ms) + d_ms) "
        "+ b_ms omega_ms + tau_back.",
        f"{len(steps) + 3}. Limits last; remember the torques that are really applied for step 5 of the next tick.",
    ]
    return steps


def _needs_velocities(tuning: Tuning) -> bool:
    observer = tuning.observer
    return observer.kind != "position" and observer.velocity_source == "measured"


def _observers(tuning: Tuning) -> str:
    if tuning.observer.kind == "position":
        return (
            "Position form: phi_l = tau_s/J_l, phi_e = (tau_applied - tau_s)/J_e, phi_ms = (tau_ms,applied - tau_back)/J_ms; "
            "x- = A x + B0 phi0 + B1 phi1, x = x- + M (theta - x-[0])."
        )
    source = "" if _needs_velocities(tuning) else "First omega+ = keep omega + gain (theta+ - theta). "
    which = "Stiffness motor only, d_l = d_e = 0" if tuning.observer.kind == "off" else "Velocity form"
    return (
        f"{source}{which}: f_l = (tau_s - b_l omega_l)/J_l, f_e = (tau_applied - tau_s - b_e omega_e)/J_e, "
        "f_ms = (tau_ms,applied - tau_back - b_ms omega_ms)/J_ms; d+ = A d + h (omega+ - omega) + b0 f0 + b1 f1."
    )


def _law(tuning: Tuning) -> str:
    controller = tuning.controller
    if controller.kind == "baseline":
        return "tau_e = N_r r - Kx [theta_l omega_l theta_e omega_e]'."
    if controller.kind == "state_feedback":
        snap = "nu = r'''' + k1 e1 + k2 e2 + k3 e3 + k4 e4"
    else:
        pull = {
            "layer": "rho min(1, max(-1, sigma/phi))",
            "tanh": "rho tanh(sigma/phi)",
            "sgn": "rho sgn(sigma)",
            "super_twisting": "1.5 sqrt(L |sigma|) sgn(sigma) + w",
        }[controller.switch]
        snap = f"sigma = s1 e1 + s2 e2 + s3 e3 + e4; nu = r'''' + s1 e2 + s2 e3 + s3 e4 + {pull}"
        if controller.switch == "super_twisting":
            snap += "; then w += 1.1 L T sgn(sigma), unless a limit cuts this tick's torque (w starts at 0)"
    return (
        "v = omega_ms/theta_ms, a_ms = r_ms''/theta_ms, delta' = omega_e - omega_l, tau_s' = k delta' - 3 tau_s v; "
        "a_l = tau_s/J_l - (b_l/J_l) omega_l - d_l; j_l = tau_s'/J_l - (b_l/J_l) a_l - d_l'; "
        f"e1 = r - theta_l, e2 = r' - omega_l, e3 = r'' - a_l, e4 = r''' - j_l; {snap}; "
        "R = -tau_s delta'^2/4 - 6 k delta' v + 12 tau_s v^2 - 3 tau_s a_ms; "
        "tau_e = J_e (a_l + (J_l (nu + d_l'') + b_l j_l - R)/k + d_e) + tau_s + b_e omega_e."
    )
