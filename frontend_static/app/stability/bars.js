import { element, setText } from "../element.js";
import { compact } from "../quantity.js";

/** A named figure with a thin bar below it: how much there is, and from where on it is thin. */
export class MarginBar {
  /** @param {string} name @param {string} title what it means @param {{full: number, thin?: number}} scale of the bar */
  constructor(name, title, { full, thin }) {
    this.full = full;
    this.figure = element("span", { class: "bar-figure" });
    this.fill = element("span", { class: "bar-fill" });
    this.root = barRow(name, title, this.figure, [this.fill, mark("thin", thin === undefined ? null : thin / full)]);
  }

  /** @param {number|null} value of the bar; null is none, NaN unknown @param {string} text @param {boolean|null} isThin
   *  @param {boolean} [isLeast] whether what lies above the value is good, not what lies below */
  show(value, text, isThin, isLeast = false) {
    setText(this.figure, text);
    const end = value === null ? 1 : Math.min(1, value / this.full);
    place(this.fill, isLeast ? end : 0, isLeast && !Number.isNaN(end) ? 1 : end);
    this.root.dataset.tone = tone(isThin);
  }
}

/** A range of factors about 1 on a logarithmic bar from a tenth to tenfold; the stable part is drawn, and what is so at present. */
export class RangeBar {
  #ends = [element("span", { class: "bar-end" }), element("span", { class: "bar-end" })];

  constructor(name, title) {
    this.fill = element("span", { class: "bar-fill" });
    this.present = mark("present", null);
    const figure = element("span", { class: "bar-figure" }, this.#ends[0], element("i", {}, "…"), this.#ends[1]);
    this.root = barRow(name, title, figure, [this.fill, mark("one", 0.5), this.present]);
    this.title = title;
  }

  /** @param {number|null} below @param {number|null} above nearest borders, null: none within ten @param {boolean|null} isThin
   *  @param {number} [present] true / nominal */
  show(below, above, isThin, present) {
    setText(this.#ends[0], factorText(below, "<0.1"));
    setText(this.#ends[1], factorText(above, ">10"));
    const [low, high] = [share(below ?? 0.1), share(above ?? 10)];
    place(this.fill, low, Number.isNaN(low + high) ? 0 : high);
    this.root.dataset.tone = tone(isThin);
    this.present.hidden = !(present > 0);
    if (!(present > 0)) return;
    this.present.style.left = `${100 * share(present)}%`;
    const isOutside = (below !== null && present < below) || (above !== null && present > above);
    this.present.classList.toggle("is-outside", isOutside);
    this.root.title = `${this.title}\nNow: ${compact(present)} of what the controller assumes${isOutside ? ", outside the stable range" : ""}.`;
  }
}

function barRow(name, title, figure, drawn) {
  return element(
    "div",
    { class: "bar-row", title },
    element("dt", {}, name),
    element("dd", {}, figure, element("span", { class: "bar" }, ...drawn)),
  );
}

function mark(kind, where) {
  const made = element("span", { class: `bar-mark bar-${kind}`, hidden: where === null });
  if (where !== null) made.style.left = `${100 * where}%`;
  return made;
}

function place(fill, from, to) {
  fill.style.left = `${100 * (from || 0)}%`;
  fill.style.width = `${100 * Math.max(0, (to || 0) - (from || 0))}%`;
}

/** Where a factor lies on the bar, 0 to 1. */
function share(factor) {
  return Math.min(1, Math.max(0, (Math.log10(factor) + 1) / 2));
}

function factorText(factor, none) {
  if (factor === null) return none;
  return Number.isNaN(factor) ? "–" : `×${compact(factor)}`;
}

function tone(isThin) {
  return isThin === null ? "" : isThin ? "thin" : "ample";
}
