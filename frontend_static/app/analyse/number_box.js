import { element } from "../element.js";
import { inputText, readNumber } from "../quantity.js";

/** A number box of a form; shown numbers are `factor` times the SI value, with so many digits. */
export class NumberBox {
  constructor(label, factor = 1, digits = 6) {
    this.label = label;
    this.digits = digits;
    this.factor = factor;
    this.root = element("input", {
      type: "text",
      class: "number",
      inputmode: "decimal",
      autocomplete: "off",
      spellcheck: "false",
      "aria-label": label,
    });
  }

  /** @param {number} value SI */
  set(value) {
    this.root.value = inputText(Number((value * this.factor).toPrecision(this.digits)));
    this.root.removeAttribute("aria-invalid");
  }

  /** @returns {number} SI @throws {Error} with a sentence if it is not a number */
  read() {
    const shown = readNumber(this.root.value);
    const isGood = Number.isFinite(shown);
    this.root.setAttribute("aria-invalid", String(!isGood));
    if (!isGood) throw new Error(`${this.label} is “${this.root.value.trim()}”; expected a number.`);
    return shown / this.factor;
  }
}
