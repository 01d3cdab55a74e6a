import { wordOf } from "../parameters/choice_word.js";
import { element } from "../element.js";
import { inputText } from "../quantity.js";

/**
 * What differs: parameter, symbol, from, to, unit; with a checkbox for each where some of it may be chosen.
 * A field of another kind goes with that kind: without the kind its box is off.
 *
 * Event `change` when another choice was made.
 */
export class DifferenceTable extends EventTarget {
  #boxes = new Map();

  /** @param {boolean} isChoice whether there are checkboxes */
  constructor(isChoice) {
    super();
    this.isChoice = isChoice;
    this.table = element("table", { class: "difference-table" });
    this.refused = element("ul", { class: "difference-refused", hidden: true });
    this.root = element("div", {}, this.table, this.refused);
  }

  /** @returns {string[]} paths of the chosen changes */
  get chosen() {
    return [...this.#boxes].filter(([, box]) => box.checked && !box.disabled).map(([path]) => path);
  }

  /** @returns {boolean} whether all that differs is chosen */
  get isWhole() {
    return this.chosen.length === this.#boxes.size;
  }

  show({ changes, refused }, from, to, isChoice = this.isChoice) {
    this.#boxes.clear();
    this.table.hidden = changes.length === 0;
    const heads = ["parameter", "", from, to, "unit"].map((text) => element("th", { scope: "col" }, text));
    if (isChoice) heads.unshift(element("th", { scope: "col" }, element("span", { class: "unseen" }, "apply")));
    this.table.replaceChildren(
      element("thead", {}, element("tr", {}, ...heads)),
      element("tbody", {}, ...changes.map((change) => this.#row(change, isChoice))),
    );
    this.refused.hidden = refused.length === 0;
    this.refused.replaceChildren(
      ...refused.map(({ field, message }) =>
        element("li", {}, `${field} does not fit this version of the program: ${message}.`),
      ),
    );
    this.#settle();
  }

  #row({ path, label, symbol, unit, from, to, words }, isChoice) {
    const place = path.split(".").slice(0, -1).join(" ").replaceAll("_", " ");
    const name = path.endsWith("kind") ? "kind" : label;
    const cells = [
      element("th", { scope: "row", title: words }, name, place ? element("small", {}, place) : null),
      element("td", { class: "symbol" }, symbol.replace("_", "")),
      element("td", { class: "figure" }, text(from)),
      element("td", { class: "figure" }, text(to)),
      element("td", { class: "unit" }, unit),
    ];
    if (isChoice) {
      const box = element("input", { type: "checkbox", checked: true, "aria-label": words, change: () => this.#chose() });
      this.#boxes.set(path, box);
      cells.unshift(element("td", {}, box));
    }
    return element("tr", { "data-path": path }, ...cells);
  }

  #chose() {
    this.#settle();
    this.dispatchEvent(new Event("change"));
  }

  #settle() {
    const kinds = [...this.#boxes].filter(([path]) => path.endsWith(".kind"));
    for (const [path, box] of this.#boxes) {
      const owner = kinds.find(([kind]) => kind !== path && path.startsWith(kind.slice(0, -"kind".length)));
      box.disabled = owner !== undefined && !owner[1].checked;
    }
  }
}

function text(value) {
  if (value === null || value === undefined) return "–";
  return typeof value === "number" ? inputText(value).replace("-", "−") : wordOf(value);
}

/** @returns {string} "1 change", "3 changes" */
export function changesText(count) {
  return `${count} change${count === 1 ? "" : "s"}`;
}
