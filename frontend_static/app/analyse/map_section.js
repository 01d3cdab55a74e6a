import { element, setText } from "../element.js";
import { valueAt } from "../document/scenario_document.js";
import { compact } from "../quantity.js";
import { Tip } from "../tip.js";
import { MapCanvas } from "./map_canvas.js";
import { LAYERS, colourRange } from "./map_layers.js";

const MOVES = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowDown: [0, -1], ArrowUp: [0, 1] };
const TRUE_FACTORS = {
  spring: ["actuator.stiffness.spring_constant", "tuning.model.spring_constant"],
  link_inertia: ["actuator.link.inertia", "tuning.model.link_inertia"],
  motor_inertia: ["actuator.motor.inertia", "tuning.model.motor_inertia"],
};

function capital(words) {
  return `${words[0].toUpperCase()}${words.slice(1)}`;
}

/** The newest map, with its values under the pointer or, by the arrow keys, under a cell cursor. */
export class MapSection {
  #cell = null;

  constructor(axes, palette, theme) {
    this.axes = axes;
    this.result = null;
    this.canvas = new MapCanvas(palette, (cell, event) => this.#point(cell, event));
    this.canvas.canvas.addEventListener("keydown", (event) => this.#step(event));
    this.tip = new Tip();
    this.caption = element("p", { class: "result-caption" });
    this.readout = element("output", { class: "result-readout" });
    this.empty = element(
      "p",
      { class: "result-overlay" },
      "No map yet. Choose two parameters on the left, or a usual pair of them, and compute.",
    );
    this.root = element(
      "div",
      { class: "result-section" },
      element("div", { class: "result-head" }, this.caption, this.readout),
      this.canvas.root,
      this.empty,
    );
    theme.addEventListener("change", () => this.canvas.draw());
  }

  /** @param {object} result of a map's task @param {object|null} asked what this page remembers of it @param {object} scenario in force */
  take(result, asked, scenario) {
    this.result = result;
    this.scenario = asked?.scenario ?? scenario;
    this.#cell = null;
    this.show(asked?.layer ?? (result.kind === "stability_map" ? "stability" : "disk"));
  }

  /** Show a layer of the present result, if it has it. */
  show(layer) {
    const { result } = this;
    if (!result || LAYERS[layer].kind !== result.kind) return;
    this.layer = LAYERS[layer];
    const [x, y] = [result.x, result.y].map(({ name, values }) => ({ axis: this.axes.find((axis) => axis.name === name), values }));
    const values = this.layer.values(result);
    this.picture = {
      x,
      y,
      values,
      stable: result.stable,
      growth: result.growth,
      range: colourRange(values, result.stable),
      unit: this.layer.unit,
      legend: this.layer.legend,
      thin: this.layer.thin,
      marks: this.#marks(x.axis, y.axis),
    };
    this.empty.hidden = true;
    const cells = result.stable.flat();
    const share = Math.round((100 * cells.filter(Boolean).length) / cells.length);
    const where = `on ${result.plant === "model" ? "its model" : "the actuator"}${[x, y].some(({ axis }) => axis.name === "stiffness") ? "" : ` at ${compact(result.stiffness)} N·m/rad`}`;
    const note = result.note ? ` Note: ${result.note}.` : "";
    const actual = this.picture.marks.length > 1 ? ", ◇ the simulated actuator" : "";
    setText(this.caption, `${capital(this.layer.legend)}, ${where}; stable in ${share} % of the map. ⊕ the present tuning${actual}.${note}`);
    this.canvas.canvas.setAttribute("aria-label", `Map of ${y.axis.label} over ${x.axis.label}: ${this.caption.textContent} Arrow keys read values.`);
    this.canvas.show(this.picture);
    setText(this.readout, "");
  }

  #marks(x, y) {
    const { scenario, result } = this;
    if (!scenario) return [];
    const present = { kind: "present", x: x.present(scenario, result.stiffness), y: y.present(scenario, result.stiffness) };
    const actual = { kind: "actual", x: this.#actual(x, present.x), y: this.#actual(y, present.y) };
    const differs = result.plant === "model" && (actual.x !== present.x || actual.y !== present.y);
    return differs ? [actual, present] : [present];
  }

  #actual(axis, present) {
    const paths = TRUE_FACTORS[axis.name];
    return paths ? valueAt(this.scenario, paths[0]) / valueAt(this.scenario, paths[1]) : present;
  }

  #point(cell, event) {
    const lines = cell ? this.#words(cell) : [];
    this.tip.show(event?.clientX ?? 0, event?.clientY ?? 0, lines);
  }

  #step(event) {
    const move = MOVES[event.key];
    if (!move || !this.picture) return;
    event.preventDefault();
    const [columns, rows] = [this.picture.values[0].length, this.picture.values.length];
    this.#cell ??= { i: Math.floor(columns / 2), j: Math.floor(rows / 2) };
    this.#cell.i = Math.min(columns - 1, Math.max(0, this.#cell.i + move[0]));
    this.#cell.j = Math.min(rows - 1, Math.max(0, this.#cell.j + move[1]));
    setText(this.readout, this.#words(this.#cell).join(" · "));
  }

  #words({ i, j }) {
    const { x, y, values, stable, growth } = this.picture;
    const side = ({ axis, values: along }, at) => `${axis.label} ${compact(along[at] * axis.factor)} ${axis.shownUnit}`.trim();
    const value = values[j][i];
    const shown = value === null ? "no border" : `${compact(value)} ${this.layer.unit}`.trim();
    const lines = [side(x, i), side(y, j), stable[j][i] ? `stable: ${this.layer.legend} ${shown}` : "unstable"];
    if (growth && !stable[j][i] && growth[j][i] !== null) lines.push(`grows at ${compact(growth[j][i])} 1/s`);
    return lines;
  }
}
