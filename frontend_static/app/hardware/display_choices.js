/**
 * How angles and motor torques are shown in the view Hardware: rad or degrees, gear or motor side, torque or current. Kept in
 * the browser; the session stays in SI at the gear side.
 *
 * Event `change`.
 */
const KEY = "vssea.hardware_display";
const DEGREES = 180 / Math.PI;
const CHOICES = { angle: ["rad", "deg"], side: ["gear", "motor"], torque: ["torque", "current"] };

export class DisplayChoices extends EventTarget {
  constructor() {
    super();
    const saved = JSON.parse(localStorage.getItem(KEY) ?? "{}");
    for (const [name, values] of Object.entries(CHOICES)) this[name] = values.includes(saved[name]) ? saved[name] : values[0];
  }

  choose(name, value) {
    this[name] = value;
    const { angle, side, torque } = this;
    localStorage.setItem(KEY, JSON.stringify({ angle, side, torque }));
    this.dispatchEvent(new Event("change"));
  }

  /** @returns {{unit: string, factor: number}} how an angle of the link is shown */
  get linkAngle() {
    return this.angle === "deg" ? { unit: "°", factor: DEGREES } : { unit: "rad", factor: 1 };
  }

  /** How a small angle is shown. */
  get smallAngle() {
    return this.angle === "deg" ? { unit: "°", factor: DEGREES } : { unit: "mrad", factor: 1e3 };
  }

  /** How a speed of the link is shown. */
  get linkSpeed() {
    return this.angle === "deg" ? { unit: "°/s", factor: DEGREES } : { unit: "rad/s", factor: 1 };
  }

  /** How an angle of the equilibrium motor, given at the gear side, is shown. */
  motorAngle(rig) {
    const { unit, factor } = this.linkAngle;
    return { unit, factor: factor * (this.side === "motor" ? (rig.gear_ratio ?? 1) : 1) };
  }

  /** How a torque of the equilibrium motor, given at the gear side [N m], is shown. */
  motorTorque(rig) {
    const atMotor = 1 / ((rig.gear_ratio ?? 1) * (rig.efficiency ?? 1));
    if (this.torque === "current" && rig.torque_constant) return { unit: "A", factor: atMotor / rig.torque_constant };
    return this.side === "motor" ? { unit: "N·m", factor: atMotor } : { unit: "N·m", factor: 1 };
  }
}
