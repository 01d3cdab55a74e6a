import { element, setText } from "../element.js";
import { PolePlot } from "../stability/pole_plot.js";
import { compact, fixed } from "../quantity.js";
import { FrequencyChart } from "./frequency_chart.js";
import { loopGain, mapCurve, valueBetween } from "./loop_curves.js";
import { LoopTables } from "./loop_tables.js";
import { NyquistPlot } from "./nyquist_plot.js";
import { overlayColour } from "./overlay_colours.js";

const PLANT = "series-link";
const LIMITER = "series-torque";
const DASH = [5, 4];
const DEGREES = 180 / Math.PI;
const CHARTS = {
  gain: { name: "Loop gain |L|", unit: "", clip: [1e-2, 1e3], level: 1 },
  phase: { name: "Phase of L", unit: "", isPhase: true, clip: [-540, 360], level: -180 },
  sensitivity: { name: "Sensitivities", unit: "", clip: [1e-3, 10], level: 1 },
  disturbance: { name: "Load to error", unit: "mrad/(N·m)", factor: 1e3, clip: [1e-4, 1e3] },
  noise: { name: "Noise to torque", unit: "N·m/mrad", factor: 1e-3, clip: [1e-4, 1e4] },
};

/** The analysis of one loop: curves over frequency, Nyquist plot, poles, tables. */
export class LoopSection {
  constructor(analysis, palette, theme) {
    this.analysis = analysis;
    this.charts = Object.fromEntries(
      Object.entries(CHARTS).map(([name, layout]) => [name, new FrequencyChart(layout, palette, (at) => this.#point(at))]),
    );
    this.nyquist = new NyquistPlot();
    this.tables = new LoopTables();
    this.polePlot = new PolePlot();
    this.overlay = element("p", { class: "result-overlay", role: "status" });
    this.frequency = element("output", { class: "frequency-readout" });
    this.subject = element("p", { class: "loop-subject" });
    const { gain, phase, sensitivity, disturbance, noise } = this.charts;
    this.root = element(
      "div",
      { class: "loop-section" },
      element(
        "div",
        { class: "loop-charts" },
        ...[gain, this.nyquist, phase, sensitivity, disturbance, noise].map((chart) => chart.root),
        this.overlay,
      ),
      element(
        "div",
        { class: "loop-side", tabindex: "0", role: "group", "aria-label": "Margins and poles of the loop" },
        this.subject,
        this.frequency,
        this.tables.margins,
        this.tables.ranges,
        element("h3", {}, "Poles"),
        this.polePlot.root,
        this.tables.poles,
        this.tables.bounds,
      ),
    );
    analysis.addEventListener("change", () => this.#show());
    theme.addEventListener("change", () => Object.values(this.charts).forEach((chart) => chart.redraw()));
    this.#show();
    this.#point(null);
  }

  #show() {
    const { report, overlays, problem, isOld, isBusy } = this.analysis;
    this.root.classList.toggle("is-old", Boolean(report) && (isOld || isBusy));
    const none = problem || (report ? "" : "The loop is being analysed.");
    const isUnstable = report && !report.stable;
    setText(this.overlay, none || (isUnstable ? "The closed loop is unstable: it has no frequency response. Its poles are on the right." : ""));
    this.overlay.hidden = !this.overlay.textContent;
    if (report === this.shown && overlays === this.shownOverlays) return;
    [this.shown, this.shownOverlays] = [report, overlays];
    this.#draw(report, report ? overlays : []);
  }

  #draw(report, overlays) {
    const base = report?.stable ? report : null;
    const others = overlays.filter((each) => each.stable);
    const plant = base && loopGain(base, "S");
    const limiter = base && loopGain(base, "S_limiter");
    const margins = base?.robustness.margins;
    const curves = (of, main) => [
      ...main.filter(({ curve }) => curve).map(({ curve, ...look }) => ({ ...look, x: curve.frequencies, y: of(curve) })),
      ...others.map((each) => {
        const curve = main[0].again(each);
        return { colour: overlayColour(each.stiffness), width: 1.25, x: curve.frequencies, y: of(curve) };
      }),
    ];
    const size = ({ magnitude }) => magnitude;
    const loops = [
      { curve: plant, label: "plant input", colour: PLANT, again: (each) => loopGain(each, "S") },
      { curve: limiter, label: "limiter", colour: LIMITER, dash: DASH },
    ];
    const map = (name, label, colour, dash) => ({
      curve: base && mapCurve(base, name),
      label,
      colour,
      dash,
      again: (each) => mapCurve(each, name),
    });
    this.charts.gain.show(curves(size, loops), plant ? gainMarks(margins.plant) : []);
    this.charts.phase.show(curves(({ phase }) => phase, loops), plant ? phaseMarks(margins.plant, plant) : []);
    this.charts.sensitivity.show(
      curves(size, [map("S", "S", PLANT), map("T", "T", "series-deflection"), map("S_limiter", "S lim.", LIMITER, DASH)]),
    );
    this.charts.disturbance.show(
      curves(size, [
        map("link_disturbance_to_error", "link", "series-disturbance"),
        map("motor_disturbance_to_error", "motor", "series-motor-disturbance", DASH),
      ]),
    );
    this.charts.noise.show(
      curves(size, [map("link_noise_to_torque", "link", PLANT), map("motor_noise_to_torque", "motor", LIMITER, DASH)]),
    );
    this.nyquist.show(
      plant
        ? [
            { curve: plant, colour: PLANT, name: "plant input" },
            { curve: limiter, colour: LIMITER, dash: true, name: "limiter" },
            ...others.map((each) => ({
              curve: loopGain(each, "S"),
              colour: overlayColour(each.stiffness),
              name: `${compact(each.stiffness)} N·m/rad`,
            })),
          ]
        : [],
      margins?.plant ?? null,
    );
    this.tables.show(report);
    this.polePlot.root.toggleAttribute("hidden", !report);
    if (report) this.polePlot.show(report.poles, report.sample_time_s, null);
    setText(this.subject, report ? subjectWords(report) : "");
    this.subject.dataset.tone = report?.warning ? (report.stable ? "warning" : "unstable") : "";
  }

  #point(frequency) {
    for (const chart of Object.values(this.charts)) chart.tell(frequency);
    this.nyquist.tell(frequency);
    setText(
      this.frequency,
      frequency === null ? "Point at a curve to read values." : `ω = ${compact(frequency)} rad/s, ${compact(frequency / (2 * Math.PI))} Hz`,
    );
  }
}

function subjectWords({ scenario, stiffness, plant, warning, stable, note }) {
  const verdict = warning ? `${warning.sentence[0].toUpperCase()}${warning.sentence.slice(1)}` : "Stable; no margin is thin";
  const where = `${scenario} at ${compact(stiffness)} N·m/rad on ${plant === "model" ? "its model" : "the actuator"}`;
  return `${verdict}. ${where}.${note && stable ? ` Note: ${note}.` : ""}`;
}

/** From |L| to 1: the factor that may come on top. */
function gainMarks({ gain_up, gain_up_frequency, gain_down, gain_down_frequency }) {
  const marks = [];
  for (const [gain, at] of [
    [gain_up, gain_up_frequency],
    [gain_down, gain_down_frequency],
  ])
    if (gain !== null && at !== null)
      marks.push({ at, from: 1 / gain, to: 1, text: `×${compact(gain)}`, colour: "text" });
  return marks;
}

/** From the nearest odd multiple of 180° to the phase at the crossover. */
function phaseMarks({ phase, phase_frequency }, curve) {
  if (phase === null || phase_frequency === null) return [];
  const to = valueBetween(curve.frequencies, curve.phase, phase_frequency);
  const from = 360 * Math.round((to + 180) / 360) - 180;
  return [{ at: phase_frequency, from, to, text: `${fixed(phase * DEGREES, 1)}°`, colour: "text" }];
}
