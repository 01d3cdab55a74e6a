import { element, setText } from "../element.js";
import { briefly, inputText, readNumber } from "../quantity.js";
import { ParameterRow } from "./parameter_row.js";

const LINES_SHOWN = 5;

/** Two lists of numbers of one length, such as the times and positions of a recorded course, as lines of text or a file. */
export class SamplesRow extends ParameterRow {
  #isTyping = false;

  /** @param {Field} field of the first list @param {Field} other of the second; the place's value is a pair of lists */
  constructor(field, other, place, hint) {
    const columns = [field, other].map(({ title, unit }) => `${title} ${unit}`);
    const label = `Samples, a line each: ${columns.join(", ")}`;
    const text = element("textarea", { rows: LINES_SHOWN, spellcheck: "false", "aria-label": label });
    const apply = element("button", { type: "button" }, "Apply");
    const file = element("input", { type: "file", accept: ".csv,.txt,text/csv,text/plain", hidden: true });
    const open = element("button", { type: "button", class: "quiet", click: () => file.click() }, "Open a CSV file…");
    const summary = element("span", { class: "samples-summary" });
    const pair = Object.assign(Object.create(Object.getPrototypeOf(field)), field, {
      default: [field.default, other.default],
    });
    const tools = element("div", { class: "line" }, apply, open);
    super(pair, place, hint, [summary, text, tools, file]);
    this.root.classList.add("row-samples");
    Object.assign(this, { text, summary, apply });
    text.placeholder = columns.join(", ");
    text.addEventListener("input", () => this.#typing(true));
    text.addEventListener("keydown", (event) => event.key === "Enter" && event.ctrlKey && this.#apply());
    apply.addEventListener("click", () => this.#apply());
    file.addEventListener("change", () => this.#read(file));
    this.#typing(false);
  }

  get isBusy() {
    return this.#isTyping;
  }

  isSame(one, other) {
    return JSON.stringify(one) === JSON.stringify(other);
  }

  words([times]) {
    return `${times.length} samples`;
  }

  show([times, values]) {
    this.text.value = times.map((time, i) => `${inputText(time)}, ${inputText(values[i])}`).join("\n");
    const span = times.length ? `, ${briefly(times[0])} to ${briefly(times.at(-1))} ${this.field.unit}` : "";
    setText(this.summary, `${times.length}${span}`);
  }

  #typing(isTyping) {
    this.#isTyping = isTyping;
    this.apply.disabled = !isTyping;
  }

  async #read(file) {
    const [chosen] = file.files;
    file.value = "";
    if (!chosen) return;
    this.text.value = await chosen.text();
    this.#apply();
  }

  async #apply() {
    const samples = readSamples(this.text.value);
    if (typeof samples === "string") return this.say(samples, "refused");
    this.#typing(!(await this.send(samples)));
    this.settle();
  }
}

/** @returns {[number[], number[]]|string} both columns of a text, or what is wrong with it; a first line of words is a title */
export function readSamples(text) {
  const lines = text.split(/\r?\n/).map((line, i) => ({ line: line.trim(), number: i + 1 }));
  const filled = lines.filter(({ line }) => line && !line.startsWith("#"));
  if (filled.length && Number.isNaN(readNumber(parts(filled[0].line)[0]))) filled.shift();
  const columns = [[], []];
  for (const { line, number } of filled) {
    const pair = parts(line).map(readNumber);
    if (pair.length < 2 || !pair.slice(0, 2).every(Number.isFinite))
      return `Line ${number} is “${line.slice(0, 30)}”; expected two numbers, such as 0.5, 0.2`;
    columns[0].push(pair[0]);
    columns[1].push(pair[1]);
  }
  return columns;
}

/** A comma parts numbers unless something else does. */
function parts(line) {
  return line.split(/[;\t]/.test(line) ? /\s*[;\t]\s*/ : /\s*,\s*|\s+/);
}
