import { element } from "../element.js";
import { Segmented } from "../parameters/segmented.js";
import { LAYERS } from "./map_layers.js";
import { NumberBox } from "./number_box.js";
import { row } from "./subject_panel.js";
import { TaskForm } from "./task_form.js";

const PRESETS = [
  { text: "stiffness × link inertia", x: "spring", y: "link_inertia", title: "True against assumed values" },
  { text: "k × g", x: "stiffness", y: "bandwidth", title: "Commanded stiffness and observer bandwidth" },
  { text: "motor inertia × delay", x: "motor_inertia", y: "delay_s", title: "True motor inertia and additional delay" },
];
const RESOLUTIONS = [30, 60, 120];

/** What map to compute: two axes with their ranges, what is shown, how finely. */
export class MapForm {
  /** @param {import("./axes.js").Axis[]} axes @param {object} subject @param {object} board @param {(layer: string) => void} chosen */
  constructor(axes, subject, board, chosen) {
    this.axes = axes;
    this.board = board;
    this.subject = subject;
    this.x = new AxisFields("x", axes);
    this.y = new AxisFields("y", axes);
    this.layer = element("select", { "aria-label": "Shown", change: () => chosen(this.layer.value) });
    this.layer.append(...Object.entries(LAYERS).map(([name, { title }]) => new Option(title, name)));
    this.count = 60;
    this.resolution = new Segmented(
      "Resolution",
      RESOLUTIONS.map((count) => ({ value: count, text: `${count}²` })),
      (count) => this.#chooseCount(count),
    );
    this.#chooseCount(this.count);
    const presets = PRESETS.map(({ text, x, y, title }) =>
      element("button", { type: "button", class: "chip", title, click: () => this.choose(x, y) }, text),
    );
    this.form = new TaskForm(
      "Map over two parameters",
      [
        element("div", { class: "chips", role: "group", "aria-label": "Usual pairs of axes" }, ...presets),
        ...this.x.rows,
        ...this.y.rows,
        row("shown", this.layer),
        row("points", this.resolution.root),
      ],
      "Compute the map",
      () => this.ask(),
    );
    this.root = this.form.root;
    this.choose("spring", "link_inertia");
  }

  choose(x, y) {
    this.x.choose(x);
    this.y.choose(y);
  }

  async ask() {
    const body = {
      ...this.subject.request,
      kind: LAYERS[this.layer.value].kind,
      x: { ...this.x.read(), count: this.count },
      y: { ...this.y.read(), count: this.count },
    };
    const { scenario } = this.subject.document;
    await this.board.ask(body, {
      words: `${this.x.axis.label} × ${this.y.axis.label}`,
      layer: this.layer.value,
      scenario: structuredClone(scenario),
    });
  }

  #chooseCount(count) {
    this.count = count;
    this.resolution.show(count);
  }
}

class AxisFields {
  constructor(letter, axes) {
    this.axes = axes;
    this.select = element("select", { "aria-label": `Axis ${letter}`, change: () => this.choose(this.select.value) });
    this.select.append(...axes.map((axis) => new Option(axis.label, axis.name)));
    this.low = new NumberBox(`lowest value on ${letter}`);
    this.high = new NumberBox(`highest value on ${letter}`);
    this.unit = element("span", { class: "form-unit" });
    this.rows = [
      row(letter === "x" ? "x →" : "y ↑", this.select),
      row("from", this.low.root, element("span", { class: "form-unit" }, "to"), this.high.root, this.unit),
    ];
  }

  choose(name) {
    this.axis = this.axes.find((axis) => axis.name === name);
    this.select.value = name;
    for (const box of [this.low, this.high]) box.factor = this.axis.factor;
    this.low.set(this.axis.low);
    this.high.set(this.axis.high);
    this.unit.textContent = this.axis.shownUnit;
  }

  read() {
    return { name: this.axis.name, low: this.low.read(), high: this.high.read() };
  }
}
