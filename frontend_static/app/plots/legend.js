import { element, setText } from "../element.js";
import { decimalsFor, fixed } from "../quantity.js";

/**
 * The legend of one chart: a button a series with its live value. Its decimals follow the y scale, not the value, so that
 * nothing jumps.
 */
export class Legend {
  /** @param {object[]} entries {label, unit, factor, colour, isDashed, isHidden, toggle(isHidden), words: a fixed text as value} */
  constructor(entries) {
    this.items = entries.map((entry) => new LegendItem(entry));
    this.scaleReset = element(
      "button",
      { type: "button", class: "legend-reset", hidden: true, title: "Back to automatic scaling" },
      "y by hand ↺",
    );
    this.root = element("div", { class: "legend" }, ...this.items.map((item) => item.root), this.scaleReset);
  }
}

class LegendItem {
  constructor(entry) {
    this.entry = entry;
    this.value = element("span", { class: "legend-value" }, entry.words);
    this.delta = element("span", { class: "legend-delta", hidden: true });
    this.others = element("span", { class: "legend-others", hidden: true });
    this.label = element("span", { class: "legend-label" }, entry.label);
    const swatch = element("span", { class: entry.isDashed ? "swatch dashed" : "swatch" });
    swatch.style.setProperty("--colour", `var(--${entry.colour})`);
    this.root = element(
      "button",
      {
        type: "button",
        class: "legend-item",
        title: `Show or hide ${entry.title ?? entry.label}`,
        click: () => this.#toggle(),
      },
      swatch,
      this.label,
      this.value,
      element("span", { class: "legend-unit" }, entry.unit),
      this.delta,
      this.others,
    );
    if (entry.isStatic) this.root.disabled = true;
    this.#mark();
  }

  /** @param {number} value SI @param {{min: number, max: number}} range of the y scale, SI @param {number} difference B - A, SI
   *  @param {{overlay: object, value: number}[]} others the same signal of the overlays */
  show(value, { min, max }, difference, others = []) {
    const { factor } = this.entry;
    const magnitude = Math.max(Math.abs(min), Math.abs(max)) * factor;
    const decimals = decimalsFor(magnitude);
    this.#reserve(min < 0 ? `−${fixed(magnitude, decimals)}` : fixed(magnitude, decimals));
    setText(this.value, fixed(value * factor, decimals));
    this.delta.hidden = Number.isNaN(difference);
    setText(this.delta, Number.isNaN(difference) ? "" : `Δ ${fixed(difference * factor, decimals)}`);
    this.#showOthers(others, (value) => fixed(value * factor, decimals));
  }

  /** Each with the room that the longest value needs, so that what follows keeps its place. */
  #showOthers(others, words) {
    this.others.hidden = !others.length;
    while (this.others.childElementCount > others.length) this.others.lastElementChild.remove();
    while (this.others.childElementCount < others.length)
      this.others.append(element("span", {}, element("span", {}), element("span", { class: "legend-other" })));
    others.forEach(({ overlay, value }, i) => {
      const [label, figure] = this.others.children[i].children;
      setText(label, `${overlay.label}:`);
      setText(figure, words(value));
      figure.style.minWidth = this.value.style.minWidth;
    });
  }

  /** Keep room for the longest value of the scale. */
  #reserve(text) {
    const width = `${text.length - 0.4 * (text.match(/[.−]/g)?.length ?? 0)}ch`;
    if (this.value.style.minWidth !== width) this.value.style.minWidth = this.delta.style.minWidth = width;
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
