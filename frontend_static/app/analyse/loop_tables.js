import { element } from "../element.js";
import { compact, fixed } from "../quantity.js";

const DEGREES = 180 / Math.PI;
const MARGINS = [
  ["gain up", (m) => withFrequency(m.gain_up === null ? "any" : `×${compact(m.gain_up)}`, m.gain_up_frequency)],
  ["gain down", (m) => withFrequency(m.gain_down === null ? "any" : `×${compact(m.gain_down)}`, m.gain_down_frequency)],
  ["phase", (m) => withFrequency(m.phase === null ? "any" : `${fixed(m.phase * DEGREES, 1)}°`, m.phase_frequency)],
  ["delay", (m) => withFrequency(m.delay_s === null ? "any" : `${compact(m.delay_s * 1e3)} ms`, m.delay_frequency)],
  ["disk α", (m) => withFrequency(fixed(m.disk, 2), m.disk_frequency)],
  ["peak of |S|", (m) => withFrequency(fixed(m.sensitivity_peak, 2), m.sensitivity_peak_frequency)],
];
const RANGES = [
  ["link_inertia", "link inertia"],
  ["motor_inertia", "motor inertia"],
  ["spring_constant", "stiffness"],
];

/** Tables of margins at both breaks, of how far the true plant may be, of poles, and of what bounds the error. */
export class LoopTables {
  constructor() {
    this.margins = element("table");
    this.ranges = element("table");
    this.poles = element("table", { class: "poles-table" });
    this.bounds = element("table");
  }

  show(report) {
    for (const table of [this.margins, this.ranges, this.poles]) table.hidden = !report;
    this.bounds.hidden = !report?.error_bound;
    if (!report) return;
    if (report.error_bound) this.#showBounds(report.error_bound);
    const { robustness, poles, sample_time_s } = report;
    const { plant, limiter } = robustness.margins;
    fill(
      this.margins,
      ["margin, at rad/s", "plant input", "limiter"],
      MARGINS.map(([name, words]) => [name, ...[plant, limiter].map((each) => (each ? words(each) : ["–"]))]),
    );
    const delay = robustness.delay_s;
    fill(this.ranges, ["true / assumed", "from", "to"], [
      ...RANGES.map(([name, words]) => {
        const range = robustness[name];
        return [words, [range ? factor(range.below, "<0.1") : "–"], [range ? factor(range.above, ">10") : "–"]];
      }),
      ["more delay", ["0"], [!report.stable ? "–" : delay === null ? ">20 samples" : `${compact(delay * 1e3)} ms`]],
    ]);
    fill(
      this.poles,
      ["s [rad/s]", "damping", "Hz"],
      poles.poles.map(({ continuous: [real, imaginary], damping, natural_frequency, pair }) => [
        pair && imaginary >= 5e-3 * natural_frequency ? `${compact(real)} ± ${compact(imaginary)} j` : `${compact(real)}${pair ? " twice" : ""}`,
        [fixed(damping, 2)],
        [compact(natural_frequency / (2 * Math.PI))],
      ]),
    );
    const words = [
      poles.deadbeat ? `${poles.deadbeat} more at z = 0` : "",
      poles.note ?? "",
      `T = ${compact(sample_time_s * 1e3)} ms`,
    ].filter(Boolean);
    this.poles.append(element("caption", {}, `${words.join("; ")}.`));
  }

  /** Eqs. (11)-(13) corrected, and the exact peak gain beside them. */
  #showBounds({ link_jerk, motor_jerk, peak_error, lyapunov_bound }) {
    fill(this.bounds, ["error under these loads", "mrad"], [
      ["exact: |e| at most", [compact(peak_error * 1e3)]],
      ["by Lyapunov: at most", [compact(lyapunov_bound * 1e3)]],
    ]);
    const loads = `|d³τ/dt³| up to ${compact(link_jerk)} N·m/s³ on the link, ${compact(motor_jerk)} on the motor`;
    this.bounds.append(element("caption", {}, `${loads}: those of the scenario’s sines, the model being the plant.`));
  }
}

/** @returns {[string, string?]} a figure, and small where it is met */
function withFrequency(figure, frequency) {
  return [figure, frequency === null || frequency === undefined ? "" : `at ${compact(frequency)}`];
}

function factor(value, none) {
  return value === null ? none : `×${compact(value)}`;
}

function fill(table, head, rows) {
  table.replaceChildren(
    element("thead", {}, element("tr", {}, ...head.map((text) => element("th", { scope: "col" }, text)))),
    element(
      "tbody",
      {},
      ...rows.map(([name, ...cells]) =>
        element(
          "tr",
          {},
          element("th", { scope: "row" }, name),
          ...cells.map(([figure, small]) => element("td", {}, figure, small ? element("small", {}, small) : null)),
        ),
      ),
    ),
  );
}
