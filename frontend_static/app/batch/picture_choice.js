import { element } from "../element.js";
import { Segmented } from "../parameters/segmented.js";
import { GATHERINGS, HeatMap } from "./heat_map.js";
import { Histogram } from "./histogram.js";
import { cellScale } from "./cell_scales.js";
import { Scatter } from "./scatter.js";

const KINDS = [
  { value: "map", text: "Map" },
  { value: "scatter", text: "Scatter" },
  { value: "histogram", text: "Histogram" },
  { value: "refused", text: "Not done" },
];
const LABELS = ["across", "up", "figure", "colours", "of several"];
const FIRST_FIGURE = "rms_error";

/** What is drawn of the results: a map, a scatter plot, a histogram or the list of runs that did not do; and of which columns. */
export class PictureChoice {
  #known = "";
  #axesOf = ""; // the kind of picture that the axes were offered for

  /** @param {() => void} changed */
  constructor(changed) {
    this.changed = changed;
    this.kind = "map";
    this.kinds = new Segmented("Picture", KINDS, (kind) => this.#choose(kind));
    this.x = this.#select("Across");
    this.y = this.#select("Up");
    this.figure = this.#select("Figure");
    this.group = this.#select("Colours");
    this.gathering = this.#select("Of several runs in a cell");
    this.gathering.append(...Object.entries(GATHERINGS).map(([name, { title }]) => new Option(title, name)));
    this.labels = new Map([this.x, this.y, this.figure, this.group, this.gathering].map((select, i) => [select, element("label", {}, LABELS[i], select)]));
    this.root = element("div", { class: "picture-choice" }, this.kinds.root, element("div", { class: "picture-columns" }, ...this.labels.values()));
    this.#arrange();
  }

  /** Offer the columns of another batch. @param {import("./columns.js").Columns} columns */
  offer(columns) {
    this.columns = columns;
    const key = [...columns.paths, "/", ...columns.figures].join();
    if (key === this.#known) return;
    this.#known = key;
    this.kind = columns.paths.length > 1 ? "map" : columns.paths.length ? "scatter" : "histogram";
    fill(this.figure, columns, columns.figures, FIRST_FIGURE);
    const words = columns.paths.filter((path) => columns.describe(path).options);
    this.group.replaceChildren(...words.map((path) => new Option(columns.describe(path).label, path)), new Option("one", ""));
    this.group.value = words[0] ?? "";
    this.#offerAxes();
    this.#arrange();
  }

  /** @returns {string[]} names of the columns that the picture needs */
  get names() {
    return this.#shown().map(({ value }) => value).filter(Boolean);
  }

  /** Say how many runs did not do. */
  count(unwell) {
    this.kinds.label("refused", unwell ? `Not done ${unwell}` : "Not done");
  }

  /** @param {import("./result_table.js").ResultTable} table @returns {object|null} a picture, see plot_canvas.js */
  picture(table) {
    const [runs, states] = [table.column("run"), table.column("state")];
    const describe = (select) => this.columns.describe(select.value);
    const shown = (select) => {
      const { factor } = describe(select);
      return table.column(select.value).map((value) => (typeof value === "number" ? value * factor : value));
    };
    if (this.kind === "histogram") {
      const values = shown(this.figure);
      return new Histogram(runs.map((run, i) => ({ run, state: states[i], value: values[i] })), describe(this.figure));
    }
    const [x, y] = [shown(this.x), shown(this.y)];
    if (this.kind === "scatter") {
      const told = this.group.value ? table.column(this.group.value) : [];
      const groups = this.group.value ? cellScale(told, describe(this.group)) : null;
      return new Scatter(runs.map((run, i) => ({ run, state: states[i], x: x[i], y: y[i], group: told[i] })), describe(this.x), describe(this.y), groups);
    }
    const values = shown(this.figure);
    const points = runs.map((run, i) => ({ run, state: states[i], x: x[i], y: y[i], value: typeof values[i] === "number" ? values[i] : null }));
    const sides = [describe(this.x), describe(this.y)];
    const hasSeveral = this.columns.paths.length > 2 || sides.some(({ varied }) => varied && !varied.values);
    const map = new HeatMap(points, ...sides, describe(this.figure), this.gathering.value, hasSeveral);
    this.labels.get(this.gathering).hidden = !map.hasSeveral;
    return map;
  }

  #choose(kind) {
    this.kind = kind;
    this.#offerAxes();
    this.#arrange();
    this.changed();
  }

  /** A map has varied fields on its axes; a scatter plot anything, at first the figure over a field. */
  #offerAxes() {
    const { paths, figures } = this.columns;
    if (this.kind === "histogram" || this.kind === "refused") return;
    const isMap = this.kind === "map";
    const names = isMap ? paths : [...paths, ...figures];
    const isOther = this.#axesOf !== this.kind;
    this.#axesOf = this.kind;
    fill(this.x, this.columns, names, isMap ? paths[1] : (paths.find((path) => !this.columns.describe(path).options) ?? paths[0] ?? figures[0]));
    fill(this.y, this.columns, names, isMap ? paths[0] : this.figure.value, isOther);
    if (this.x.value === this.y.value && names.length > 1) this.y.value = names.find((name) => name !== this.x.value);
  }

  #arrange() {
    this.kinds.show(this.kind);
    const shown = this.#shown();
    for (const select of [this.x, this.y, this.figure, this.group]) this.labels.get(select).hidden = !shown.includes(select);
    this.labels.get(this.gathering).hidden = true;
  }

  #shown() {
    return { map: [this.x, this.y, this.figure], scatter: [this.x, this.y, ...(this.group.options.length > 1 ? [this.group] : [])], histogram: [this.figure], refused: [] }[this.kind];
  }

  #select(label) {
    return element("select", { "aria-label": label, change: () => this.changed() });
  }
}

/** Keep what was chosen where it is still offered, unless the choice is fresh. */
function fill(select, columns, names, first, isFresh = false) {
  const kept = !isFresh && names.includes(select.value) ? select.value : first;
  select.replaceChildren(...names.map((name) => new Option(columns.describe(name).label, name)));
  select.value = names.includes(kept) ? kept : names[0];
}
