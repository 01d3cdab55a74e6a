import { compact } from "../quantity.js";
import { MarginBar, RangeBar } from "./bars.js";
import { StabilityPanel } from "./stability_panel.js";
import { THIN_DELAY_SAMPLES, THIN_PARAMETER, isThinRange } from "./thresholds.js";

const LONGEST_SAMPLES = 20;
const PARAMETERS = {
  link_inertia: ["link inertia", "J_l"],
  motor_inertia: ["motor inertia", "J_e"],
  spring_constant: ["stiffness", "k"],
};

/** How far the true plant may be from what the controller assumes, each parameter by itself, before the loop is unstable. */
export class TruePlantPanel {
  constructor() {
    this.ranges = new Map(
      Object.entries(PARAMETERS).map(([name, [words, symbol]]) => [
        name,
        new RangeBar(
          words,
          `True / assumed ${words} ${symbol}: the loop is stable in between. The bar goes from a tenth to tenfold; ` +
            "the line is 1, the tick what the simulated actuator has. Thin within 1.25.",
        ),
      ]),
    );
    this.delay = new MarginBar(
      "torque delay",
      "Additional delay of the torque at which the loop becomes unstable, the change of the hold between samples included. " +
        `The bar has ${LONGEST_SAMPLES} samples.`,
      { full: LONGEST_SAMPLES, thin: THIN_DELAY_SAMPLES },
    );
    const bars = [...this.ranges.values(), this.delay];
    this.root = new StabilityPanel("True plant may differ", bars.map((bar) => bar.root)).root;
  }

  show({ robustness, true: present, stable }) {
    for (const [name, bar] of this.ranges) {
      const range = robustness[name] ?? { below: NaN, above: NaN };
      const isThin = robustness[name] ? isThinRange(range.below, range.above, THIN_PARAMETER) : null;
      bar.show(range.below, range.above, isThin, present?.[name]);
    }
    const samples = robustness.delay_samples;
    if (!stable) this.delay.show(NaN, "–", null);
    else if (samples === null) this.delay.show(null, `>${LONGEST_SAMPLES} samples`, false);
    else this.delay.show(samples, `${compact(samples)} samples`, samples < THIN_DELAY_SAMPLES);
  }
}
