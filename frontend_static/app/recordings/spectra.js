import { FrequencyChart } from "../analyse/frequency_chart.js";
import { element, setText } from "../element.js";
import { compact, displayUnit, significant } from "../quantity.js";
import { rest } from "../session/rest.js";
import { addressOf } from "./samples.js";

const CHANNELS = [
  { channel: "error", label: "tracking error", colour: "link" },
  { channel: "link_position", label: "link", colour: "link" },
  { channel: "reference", label: "reference", colour: "reference" },
  { channel: "motor_torque", label: "motor torque", colour: "torque" },
  { channel: "link_disturbance_estimate", label: "disturbance estimate", colour: "disturbance" },
  { channel: "deflection", label: "deflection", colour: "deflection" },
  { channel: "stiffness", label: "stiffness", colour: "stiffness" },
];
const CHOSEN_FIRST = ["error", "motor_torque"];
const PATIENCE_MS = 300;
const DECADES = 9; // shown below the highest density
const MOST_POINTS = 1200; // drawn of a density, evenly on a logarithmic axis
const TIME_LIMIT_MS = 120_000; // of a long span on a busy server

/** Amplitude spectral densities of chosen channels over the shown span, of the recording and of those over it. */
export class Spectra {
  #charts = new Map();
  #answers = new Map();
  #timer = null;
  #asked = "";

  /** @param {object} page {source, stack, comparison}, the open recording @param {object} palette @param {object} theme */
  constructor({ source, stack, comparison }, palette, theme) {
    this.source = source;
    this.stack = stack;
    this.palette = palette;
    this.chosen = new Set(CHOSEN_FIRST);
    this.chips = CHANNELS.map(({ channel, label, colour }) => this.#chip(channel, label, colour));
    this.readout = element("output", { class: "spectra-readout", hidden: true });
    this.problem = element("p", { class: "spectra-words", role: "status", hidden: true });
    this.area = element("div", { class: "spectra-charts" });
    this.root = element(
      "div",
      { class: "spectra", hidden: true },
      element("div", { class: "chips", role: "group", "aria-label": "Channels" }, ...this.chips),
      this.problem,
      this.area,
    );
    for (const each of [stack.timeWindow, comparison]) each.addEventListener("change", () => this.look());
    theme.addEventListener("change", () => this.#charts.forEach((chart) => chart.redraw()));
  }

  set isShown(isShown) {
    this.root.hidden = this.readout.hidden = !isShown;
    if (isShown) this.look();
  }

  /** Ask for what is shown now, unless it is there. */
  look() {
    if (this.root.hidden || this.source.isEmpty) return;
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#fetch(), PATIENCE_MS);
  }

  #chip(channel, label, colour) {
    const mark = element("span", { class: "chip-swatch" });
    mark.style.background = `var(--series-${colour})`;
    const chip = element("button", { type: "button", class: "chip", "aria-pressed": String(this.chosen.has(channel)) }, mark, label);
    chip.addEventListener("click", () => {
      if (!this.chosen.delete(channel)) this.chosen.add(channel);
      chip.setAttribute("aria-pressed", String(this.chosen.has(channel)));
      this.look();
    });
    return chip;
  }

  async #fetch() {
    const { run, overlays } = this.source;
    const [from, to] = this.stack.timeWindow.range;
    const runs = [{ run, shift: 0 }, ...overlays.filter((overlay) => overlay.run)];
    const channels = CHANNELS.filter(({ channel }) => this.chosen.has(channel) && run.channels.has(channel));
    const wanted = runs.map(({ run: one, shift }) => {
      const names = channels.map(({ channel }) => channel).filter((name) => one.channels.has(name));
      const [first, last] = one.extent;
      const span = { from_s: Math.max(first, from - shift), to_s: Math.min(last, to - shift) };
      return names.length && span.to_s > span.from_s ? addressOf(one.id, "spectrum", { channels: names.join(), ...span }) : null;
    });
    const asked = (this.#asked = wanted.join(" "));
    if (!this.area.childElementCount) this.#say("The spectra are being computed.");
    try {
      const answers = await Promise.all(wanted.map((address) => address && this.#answer(address)));
      if (asked !== this.#asked) return;
      this.#say(answers.map((answer) => answer?.note).find(Boolean) ?? "");
      this.#draw(channels, answers, runs);
    } catch (refusal) {
      if (asked === this.#asked) this.#say(refusal.message);
    }
  }

  async #answer(address) {
    if (!this.#answers.has(address)) {
      if (this.#answers.size > 50) this.#answers.clear();
      this.#answers.set(address, await rest("GET", address, undefined, TIME_LIMIT_MS));
    }
    return this.#answers.get(address);
  }

  #draw(channels, answers, runs) {
    for (const { channel, label } of channels) {
      if (this.#charts.has(channel)) continue;
      const { unit } = displayUnit(this.source.channels.get(channel)?.unit ?? "");
      const layout = { name: label, unit: `${unit}/√Hz`, xUnit: "Hz", lowest: 0.1, clip: [1e-12, 1e6] };
      this.#charts.set(channel, new FrequencyChart(layout, this.palette, (at) => this.#point(at)));
    }
    const roots = channels.map(({ channel }) => this.#charts.get(channel).root);
    this.area.dataset.count = roots.length;
    this.area.replaceChildren(...roots);
    for (const { channel, colour } of channels) {
      const chart = this.#charts.get(channel);
      const { factor, unit } = displayUnit(this.source.channels.get(channel)?.unit ?? "");
      const curves = answers.flatMap((answer, i) => {
        const density = answer?.density[channel];
        if (!density) return [];
        const name = i === 0 ? "" : `${runs[i].label}: `;
        const rms = `RMS ${significant(answer.rms[channel] * factor)} ${unit}`;
        const look = { label: name + rms, colour: `series-${colour}`, dash: runs[i].dash, alpha: runs[i].alpha };
        const [x, highest] = highestOf(answer.frequencies_hz, density);
        return [{ ...look, x, y: highest.map((value) => (value > 0 ? Math.sqrt(value) * factor : NaN)) }];
      });
      const most = Math.max(...curves.flatMap(({ y }) => y.filter(Number.isFinite)));
      Object.assign(chart.layout, { clip: [most * 10 ** -DECADES, most * 2], lowest: curves[0]?.x.find((at) => at > 0) ?? 0.1 });
      chart.show(curves);
    }
    this.#point(null);
  }

  #point(frequency) {
    for (const chart of this.#charts.values()) chart.tell(frequency);
    setText(this.readout, frequency === null ? "point at a curve to read values" : `${compact(frequency)} Hz, ${compact(2 * Math.PI * frequency)} rad/s`);
  }

  #say(text) {
    setText(this.problem, text);
    this.problem.hidden = text === "";
  }
}

/** Where a curve has more points than a plot can show, the highest of those that share a place. @returns {[number[], number[]]} */
function highestOf(frequencies, density) {
  const first = frequencies.findIndex((at) => at > 0);
  const decades = Math.log10(frequencies.at(-1) / frequencies[first]);
  const [x, y] = [[], []];
  let place = -1;
  for (let i = first; i < frequencies.length; i += 1) {
    const at = Math.floor((Math.log10(frequencies[i] / frequencies[first]) / decades) * MOST_POINTS);
    if (at !== place) [x[x.length], y[y.length], place] = [frequencies[i], density[i], at];
    else if (density[i] > y.at(-1)) [x[x.length - 1], y[y.length - 1]] = [frequencies[i], density[i]];
  }
  return [x, y];
}
