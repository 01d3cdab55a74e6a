import { NumberBox } from "../analyse/number_box.js";
import { element } from "../element.js";
import { nameFor } from "./batch_document.js";

const METHODS = [
  ["random", "at random"],
  ["latin_hypercube", "Latin hypercube"],
  ["sobol", "Sobol sequence"],
];
const KEEPS = [
  ["none", "of no run"],
  ["ended", "of runs that end early"],
  ["all", "of all runs"],
];
const NOISES = [
  ["same", "the same in all runs"],
  ["own", "another in each run"],
];

/** What a new batch has besides its varied fields: name, random draws, noise, samples kept, seed. */
export class FormOptions {
  constructor() {
    this.draws = new NumberBox("number of random draws");
    this.draws.set(1000);
    this.method = choice("How random values are spread", METHODS);
    this.random = row("draws", this.draws.root, this.method);
    this.name = element("input", { type: "text", maxlength: 80, "aria-label": "Name of the batch", placeholder: "name", autocomplete: "off", spellcheck: "false" });
    this.noise = choice("Noise", NOISES);
    this.keep = choice("Samples kept", KEEPS);
    this.seed = new NumberBox("seed of random values");
    this.seed.set(0);
    const seed = row("seed", this.seed.root, element("span", { class: "form-unit" }, "of random values"));
    const more = element("details", {}, element("summary", {}, "More"), row("noise", this.noise), row("samples", this.keep), seed);
    this.parts = [this.random, row("name", this.name), more];
  }

  /** Show what matters for these fields. @param {import("./variation_row.js").VariationRow[]} rows */
  arrange(rows) {
    this.random.hidden = !rows.some(({ isRandom }) => isRandom);
    this.name.placeholder = rows.length ? nameFor(rows) : "name";
  }

  /** @returns {object} see batch_document.js @throws {Error} with a sentence */
  read() {
    return {
      name: this.name.value.trim(),
      seed: this.seed.read(),
      noise: this.noise.value,
      keep: this.keep.value,
      draws: this.draws.read(),
      method: this.method.value,
    };
  }
}

function row(name, ...controls) {
  return element("div", { class: "form-row" }, element("span", { class: "form-name" }, name), ...controls);
}

function choice(label, options) {
  return element("select", { "aria-label": label }, ...options.map(([value, text]) => new Option(text, value)));
}
