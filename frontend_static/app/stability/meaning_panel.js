import { element, setText } from "../element.js";
import { compact } from "../quantity.js";
import { StabilityPanel } from "./stability_panel.js";

const FIGURES = [
  {
    name: "estimate follows to",
    unit: "Hz",
    title: "Frequency up to which the disturbance estimate follows a link disturbance: −3 dB.",
    of: ({ estimate_bandwidth }) => (estimate_bandwidth === null ? null : estimate_bandwidth / (2 * Math.PI)),
  },
  {
    name: "error at 1 Hz load",
    unit: "mrad/(N·m)",
    title: "Link error per newton metre of a link disturbance of 1 Hz.",
    of: ({ disturbance_error_1hz }) => disturbance_error_1hz * 1e3,
  },
  {
    name: "torque noise",
    unit: "N·m RMS",
    title: "RMS of the motor torque that the counts of the present encoders cause; zero with ideal sensors.",
    of: ({ noise }) => noise.rms,
  },
  {
    name: "chatter",
    unit: "N·m RMS",
    title: "RMS change of the motor torque from one sample to the next, from the same noise.",
    of: ({ noise }) => noise.chatter,
  },
];

/** What the tuning gives and costs, in figures that a user knows. */
export class MeaningPanel {
  constructor() {
    this.rows = FIGURES.map((figure) => ({ ...figure, value: element("span", { class: "meaning-value" }) }));
    this.root = new StabilityPanel(
      "What it means",
      this.rows.map(({ name, unit, title, value }) =>
        element(
          "div",
          { class: "meaning-row", title },
          element("dt", {}, name),
          element("dd", {}, value, element("span", { class: "meaning-unit" }, unit)),
        ),
      ),
    ).root;
  }

  show({ figures }) {
    for (const { value, of } of this.rows) setText(value, figures ? compact(of(figures)) : "–");
  }
}
