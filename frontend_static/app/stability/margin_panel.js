import { compact, fixed } from "../quantity.js";
import { MarginBar, RangeBar } from "./bars.js";
import { StabilityPanel } from "./stability_panel.js";
import { THIN_DELAY_SAMPLES, THIN_GAIN, THIN_PHASE_DEG, isThinRange } from "./thresholds.js";

const DEGREES = 180 / Math.PI;

/** Margins of the loop broken at the plant's input, and the lowest gain that saturation may leave. */
export class MarginPanel {
  constructor() {
    this.gain = new RangeBar("gain", "Factors on the motor torque between which the loop stays stable. Thin within 1.5.");
    this.phase = new MarginBar("phase", "Phase that may be lost or gained where |L| = 1. Thin below 20°.", {
      full: 90,
      thin: THIN_PHASE_DEG,
    });
    this.delay = new MarginBar(
      "delay",
      "Delay of the torque, beyond what is assumed, at which the loop becomes unstable. The bar has ten samples. Thin below 1.5.",
      { full: 10, thin: THIN_DELAY_SAMPLES },
    );
    this.disk = new MarginBar(
      "disk",
      "Balanced disk margin α: gain and phase may change at once. It is the distance of S from ½, as 1 / max |S − ½|.",
      { full: 2 },
    );
    this.limiter = new MarginBar(
      "under limits",
      "Share of the demanded torque that limits must let through for the loop to stay stable. Thin above 67 %.",
      { full: 1 },
    );
    const bars = [this.gain, this.phase, this.delay, this.disk, this.limiter];
    this.panel = new StabilityPanel("Margins", bars.map((bar) => bar.root));
    this.root = this.panel.root;
  }

  show({ robustness, sample_time_s, stiffness, note }) {
    const { plant, limiter } = robustness.margins;
    this.panel.aside(`at ${compact(stiffness)} N·m/rad`);
    this.panel.note(note ?? "");
    if (!plant) return this.#showNone();
    this.gain.show(plant.gain_down, plant.gain_up, isThinRange(plant.gain_down, plant.gain_up, THIN_GAIN));
    const phase = plant.phase === null ? null : plant.phase * DEGREES;
    this.phase.show(phase, phase === null ? "any" : `${fixed(phase, 1)}°`, phase !== null && phase < THIN_PHASE_DEG);
    const samples = plant.delay_s === null ? null : plant.delay_s / sample_time_s;
    const words = samples === null ? "any" : `${compact(plant.delay_s * 1e3)} ms, ${compact(samples)} samples`;
    this.delay.show(samples, words, samples !== null && samples < THIN_DELAY_SAMPLES);
    this.disk.show(plant.disk, `α ${fixed(plant.disk, 2)}`, null);
    const least = limiter.gain_down ?? 0;
    this.limiter.show(least, least ? `≥ ${fixed(100 * least, 0)} % of torque` : "any torque", least > 1 / THIN_GAIN, true);
  }

  #showNone() {
    this.gain.show(NaN, NaN, null);
    for (const bar of [this.phase, this.delay, this.disk, this.limiter]) bar.show(NaN, "–", null);
  }
}
