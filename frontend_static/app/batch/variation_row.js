import { NumberBox } from "../analyse/number_box.js";
import { element, setText } from "../element.js";
import { Segmented } from "../parameters/segmented.js";
import { symbol } from "../parameters/symbol.js";
import { briefly, readNumber } from "../quantity.js";
import { firstRange } from "./first_range.js";

const KINDS = [
  { value: "grid", text: "Grid", title: "Evenly spaced values, crossed with those of the other fields" },
  { value: "list", text: "List", title: "Values that you write down, crossed with those of the other fields" },
  { value: "random", text: "Random", title: "Random values, drawn together with those of the other random fields" },
];
const DISTRIBUTIONS = [
  ["uniform", "even"],
  ["log_uniform", "even in log"],
  ["normal", "normal"],
];

/** One varied field: on a grid, from a list, or at random. Gives what the batch document says of it. */
export class VariationRow {
  /** @param {object} field of scenario_fields.js @param {() => void} changed @param {() => void} removed */
  constructor(field, changed, removed) {
    this.field = field;
    this.kind = field.options ? "list" : "grid";
    this.isFactor = false;
    this.changed = changed;
    const name = field.label;
    this.low = new NumberBox(`${name}, lowest`);
    this.high = new NumberBox(`${name}, highest`);
    this.count = new NumberBox(`${name}, number of values`);
    this.mean = new NumberBox(`${name}, mean`);
    this.std = new NumberBox(`${name}, standard deviation`);
    this.values = element("input", { type: "text", "aria-label": `${name}, values`, placeholder: "values, such as 1; 2; 5", autocomplete: "off", spellcheck: "false" });
    this.spacing = new Segmented(`${name}, spacing`, [{ value: "linear", text: "even" }, { value: "log", text: "log" }], (spacing) => this.#set({ spacing }));
    this.how = new Segmented(`${name}, how it varies`, KINDS, (kind) => this.#set({ kind }));
    this.distribution = element("select", { "aria-label": `${name}, distribution` }, ...DISTRIBUTIONS.map(([value, text]) => new Option(text, value)));
    this.factor = element("input", { type: "checkbox", "aria-label": `${name}, as factors of the present value`, change: () => this.#scale() });
    this.options = (field.options ?? []).map(({ value, text }) => ({ value, box: element("input", { type: "checkbox", checked: true }), text }));
    this.units = [0, 1].map(() => element("span", { class: "form-unit" }));
    this.span = element("div", { class: "form-row" }, element("span", { class: "form-name" }, "from"), this.low.root, element("span", { class: "form-unit" }, "to"), this.high.root, this.units[0]);
    this.bell = element("div", { class: "form-row" }, element("span", { class: "form-name" }, "mean"), this.mean.root, element("span", { class: "form-unit", title: "standard deviation" }, "std"), this.std.root, this.units[1]);
    this.grid = element("div", { class: "form-row" }, element("span", { class: "form-name" }, "values"), this.count.root, this.spacing.root);
    this.list = element("div", { class: "form-row" }, this.values, element("span", { class: "form-unit" }, field.unit ?? ""));
    this.random = element("div", { class: "form-row" }, element("span", { class: "form-name" }, "drawn"), this.distribution);
    this.choices = element("div", { class: "field-choices" }, ...this.options.map(({ box, text }) => element("label", {}, box, text)));
    this.present = element("span", { class: "hint" });
    this.scaled = element("label", { title: "Multiples of what the scenario has, instead of values" }, this.factor, "× present");
    this.root = element(
      "li",
      { class: "variation", "data-path": field.path, change: () => this.#changed(), input: () => this.#changed() },
      element(
        "div",
        { class: "variation-head" },
        element("span", { class: "field-label", title: `${field.label}\n${field.path}` }, field.label, " ", field.symbol ? element("span", { class: "field-symbol" }, ...symbol(field.symbol)) : null),
        this.present,
        element("button", { type: "button", class: "quiet remove", "aria-label": `Do not vary ${field.label}`, title: "Do not vary it", click: removed }, "×"),
      ),
      field.options ? null : element("div", { class: "form-row" }, this.how.root, this.scaled),
      this.span,
      this.bell,
      this.grid,
      this.list,
      this.random,
      this.choices,
    );
    const { low, high, count, spacing } = firstRange(field);
    this.low.set(low);
    this.high.set(high);
    this.count.set(count);
    this.mean.set(typeof field.value === "number" ? field.value : (low + high) / 2);
    this.std.set((high - low) / 6);
    this.values.value = [low, (low + high) / 2, high].map((value) => briefly(value)).join("; ");
    this.distribution.value = spacing === "log" ? "log_uniform" : "uniform";
    this.#set({ spacing }, false);
  }

  get isRandom() {
    return this.kind === "random";
  }

  /** Say what the scenario has at present. */
  showPresent(value) {
    this.field.value = value;
    const words = typeof value === "number" ? briefly(value) : String(value ?? "none");
    setText(this.present, `now ${this.options.find((option) => option.value === value)?.text ?? words} ${this.field.unit ?? ""}`.trim());
    this.scaled.hidden = typeof value !== "number" || value === 0;
  }

  /** @returns {object} a Grid or a Listed of the document, or a Draw if it is random @throws {Error} with a sentence */
  read() {
    const { path } = this.field;
    const factor = this.isFactor;
    if (this.kind === "random") return { path, distribution: this.#readDistribution(), factor };
    if (this.kind === "grid") {
      const count = this.count.read();
      if (!Number.isInteger(count) || count < 1) throw new Error(`${this.count.label} is ${briefly(count)}; expected a whole number from 1.`);
      return { kind: "grid", path, low: this.low.read(), high: this.high.read(), count, spacing: this.spacing.shown, factor };
    }
    return { kind: "list", path, values: this.field.options ? this.#chosen() : this.#written(), factor };
  }

  #readDistribution() {
    const kind = this.distribution.value;
    return kind === "normal" ? { kind, mean: this.mean.read(), std: this.std.read() } : { kind, low: this.low.read(), high: this.high.read() };
  }

  #chosen() {
    const chosen = this.options.filter(({ box }) => box.checked).map(({ value }) => value);
    if (!chosen.length) throw new Error(`${this.field.label}: nothing is chosen; choose at least one.`);
    return chosen;
  }

  #written() {
    const texts = this.values.value.split(/[;\s]+|,(?=\s)/).filter(Boolean);
    const values = texts.map((text) => readNumber(text));
    const wrong = texts.find((_, i) => !Number.isFinite(values[i]));
    this.values.setAttribute("aria-invalid", String(wrong !== undefined || !values.length));
    if (wrong !== undefined) throw new Error(`${this.values.getAttribute("aria-label")}: “${wrong}” is not a number; expected numbers with ; between them.`);
    if (!values.length) throw new Error(`${this.values.getAttribute("aria-label")}: there are none; expected numbers with ; between them.`);
    return this.field.isWhole && !this.isFactor ? values.map((value) => Math.round(value)) : values;
  }

  /** The numbers in the boxes become factors of the present value, or values again. */
  #scale() {
    this.isFactor = this.factor.checked;
    const share = this.isFactor ? 1 / this.field.value : this.field.value;
    for (const box of [this.low, this.high, this.mean, this.std]) {
      const value = readNumber(box.root.value);
      if (Number.isFinite(value)) box.set(Number((value * share).toPrecision(4)));
    }
    const values = this.values.value.split(/[;\s]+/).filter(Boolean).map((text) => readNumber(text) * share);
    if (values.every(Number.isFinite)) this.values.value = values.map((value) => briefly(value)).join("; ");
    this.#arrange();
  }

  #set({ kind = this.kind, spacing = this.spacing.shown }, isTold = true) {
    this.kind = kind;
    this.how.show(kind);
    this.spacing.show(spacing);
    this.#arrange();
    if (isTold) this.changed();
  }

  #changed() {
    this.#arrange();
    this.changed();
  }

  #arrange() {
    const isChoice = Boolean(this.field.options);
    const isBell = this.isRandom && this.distribution.value === "normal";
    this.choices.hidden = !isChoice;
    this.list.hidden = isChoice || this.kind !== "list";
    this.grid.hidden = this.kind !== "grid";
    this.random.hidden = !this.isRandom;
    this.bell.hidden = !isBell;
    this.span.hidden = isBell || this.kind === "list";
    for (const unit of [...this.units, this.list.lastElementChild]) setText(unit, this.isFactor ? "× present" : (this.field.unit ?? ""));
  }
}
