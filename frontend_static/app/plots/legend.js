import { element, setText } from "../element.js";
import { decimalsFor, fixed } from "../quantity.js";

/**
 * The legend of one chart: a button a series with its live value. Its decimals follow the y scale, not the value, so that
 * nothing jumps.
 */
export class Legend {
  /** @param {object[]} entries {label, unit, factor, colour, isDashed, isHidden, toggle(isHidden)} */
  constructor(entries) {
    this.items = entries.map((entry) => new LegendItem(entry));
    this.scaleReset = element("button", { type: "button", class: "legend-reset", hidden: true, title: "Back to automatic scaling" }, "y by hand ↺");
    this.root = element("div", { class: "legend" }, ...this.items.map((item) => item.root), this.scaleReset);
  }
}

class LegendItem {
  constructor(entry) {
    this.entry = entry;
    this.value = element("span", { class: "legend-value" });
    this.delta = element("span", { class: "legend-delta", hidden: true });
    this.label = element("span", { class: "legend-label" }, entry.label);
    const swatch = element("span", { class: entry.isDashed ? "swatch dashed" : "swatch" });
    swatch.style.setProperty("--colour", `var(--${entry.colour})`);
    this.root = element(
      "button",
      { type: "button", class: "legend-item", title: `Show or hide ${entry.label}`, click: () => this.#toggle() },
      swatch,
      this.label,
      this.value,
      element("span", { class: "legend-unit" }, entry.unit),
      this.delta,
    );
    if (entry.isStatic) this.root.disabled = true;
    this.#mark();
  }

  /** @param {number} value SI @param {number} magnitude largest value of the scale, SI @param {number} difference B - A, SI */
  show(value, magnitude, difference) {
    const { factor } = this.entry;
    const decimals = decimalsFor(magnitude * factor);
    setText(this.value, fixed(value * factor, decimals));
    this.delta.hidden = Number.isNaN(difference);
    setText(this.delta, Number.isNaN(difference) ? "" : `Δ ${fixed(difference * factor, decimals)}`);
  }

  #toggle() {
    this.entry.isHidden = !this.entry.isHidden;
    this.#mark();
    this.entry.toggle(this.entry.isHidden);
  }

  #mark() {
    this.root.setAttribute("aria-pressed", String(!this.entry.isHidden));
  }
}
