import { rest } from "../session/rest.js";
import { valueAt } from "../document/scenario_document.js";

/**
 * What a map or a search may vary: axes.json has the same list as vssea_core/analysis/axes.py. Seconds are shown as
 * milliseconds.
 *
 * @returns {Promise<Axis[]>}
 */
export async function loadAxes() {
  return (await rest("GET", "app/analyse/axes.json")).map((entry) => new Axis(entry));
}

export class Axis {
  constructor(entry) {
    Object.assign(this, entry);
    this.factor = this.unit === "s" ? 1e3 : 1;
    this.shownUnit = this.unit === "s" ? "ms" : this.unit;
  }

  get isLogarithmic() {
    return this.scale === "log";
  }

  /** @returns {string} label and unit as shown */
  get title() {
    return this.shownUnit ? `${this.label} [${this.shownUnit}]` : this.label;
  }

  /** @returns {number|null} where the analysed loop lies on this axis, SI */
  present(scenario, stiffness) {
    if (this.name === "stiffness") return stiffness;
    if (this.name === "delay_s") return 0;
    if (this.name === "torque_lag_s") return valueAt(scenario, "actuator.motor.torque_lag_s") ?? null;
    if (this.name === "bandwidth") return valueAt(scenario, "tuning.observer.bandwidth") ?? null;
    if (this.name === "poles") {
      const controller = valueAt(scenario, "tuning.controller") ?? {};
      return controller.surface_pole ?? controller.natural_frequency ?? null;
    }
    return 1;
  }
}
