import { METRICS } from "../recordings/metric_words.js";
import { pathWords } from "./scenario_fields.js";
import { variedValues } from "./varied_values.js";

const LIMIT = "limit_share.";
const CHOICES = new Set(["string", "boolean"]);

const LOWERED = { a: "ₐ", e: "ₑ", h: "ₕ", k: "ₖ", l: "ₗ", m: "ₘ", n: "ₙ", o: "ₒ", p: "ₚ", s: "ₛ", t: "ₜ", x: "ₓ" };

/** What the columns of a batch's results are called, and in which unit they are shown: varied fields by the schema, figures. */
export class Columns {
  /** @param {object} batch its `paths` and `columns` @param {object[]} fields of its scenario, see scenario_fields.js
   *  @param {object} document of the batch */
  constructor({ paths, columns }, fields, document) {
    this.paths = paths;
    this.fields = new Map(fields.map((field) => [field.path, field]));
    this.varied = variedValues(document, (path) => Boolean(this.fields.get(path)?.isWhole));
    this.figures = columns.filter((name) => name in METRICS || name.startsWith(LIMIT) || name === "time_s");
  }

  /**
   * @returns {{name: string, label: string, unit: string, factor: number, title: string, isLogarithmic: boolean|null,
   *   options: object[]|null, varied: object|null}} `isLogarithmic` is null where nothing says so; `varied`: see varied_values.js
   */
  describe(name) {
    const varied = this.varied.get(name) ?? null;
    const own = this.#own(name);
    const isLogarithmic = varied?.isLogarithmic ?? (own.isLogarithmic || null);
    const found = { name, factor: 1, unit: "", options: null, ...own, isLogarithmic, varied };
    return { ...found, title: found.unit ? `${found.label} [${found.unit}]` : found.label };
  }

  #own(name) {
    if (name in METRICS) return METRICS[name];
    if (name === "time_s") return { label: "time simulated", unit: "s" };
    if (name.startsWith(LIMIT)) return { label: `limited: ${name.slice(LIMIT.length).replaceAll("_", " ")}`, unit: "%", factor: 100 };
    const field = this.fields.get(name);
    if (!field) return { label: pathWords(name) };
    return { label: `${field.label} ${plainSymbol(field.symbol)}`.trim(), unit: field.unit, isLogarithmic: field.isLogarithmic, options: field.options };
  }

  /** @returns {string} a value in words, with its unit unless `isBare` */
  words(name, value, write) {
    const { factor, unit, options } = this.describe(name);
    if (value === null || value === undefined) return "–";
    if (CHOICES.has(typeof value)) return options?.find((option) => String(option.value) === String(value))?.text ?? String(value);
    return `${write(value * factor)} ${unit}`.trim();
  }
}

/** @returns {string} a symbol without markup, "" for one that cannot be written so */
function plainSymbol(text) {
  const [, base, index] = text.match(/^([^_]+)(?:_([a-z]))?$/) ?? [];
  if (!base) return "";
  return index ? (LOWERED[index] ? `${base}${LOWERED[index]}` : "") : base;
}
