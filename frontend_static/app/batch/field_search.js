import { element } from "../element.js";
import { symbol } from "../parameters/symbol.js";

const MOST = 150;

/** A box that finds fields of the scenario by words, and a list of those found: arrow keys move, Enter or a click takes one. */
export class FieldSearch {
  #fields = [];
  #taken = new Set();
  #at = 0;
  #found = [];

  /** @param {(field: object) => void} choose */
  constructor(choose) {
    this.choose = choose;
    this.list = element("ul", { id: "batch-fields", class: "field-options", role: "listbox", "aria-label": "Fields found", hidden: true });
    this.box = element("input", {
      type: "text",
      role: "combobox",
      class: "field-box",
      "aria-label": "Field to vary",
      "aria-expanded": "false",
      "aria-controls": "batch-fields",
      "aria-autocomplete": "list",
      placeholder: "field to vary, such as link inertia",
      autocomplete: "off",
      spellcheck: "false",
      input: () => this.#show(),
      focus: () => this.#show(),
      blur: () => this.#close(),
      keydown: (event) => this.#key(event),
    });
    this.root = element("div", { class: "field-search" }, this.box, this.list);
  }

  /** @param {object[]} fields all there are @param {Set<string>} taken paths of those that are chosen already */
  offer(fields, taken) {
    [this.#fields, this.#taken] = [fields, taken];
    if (!this.list.hidden) this.#show();
  }

  #show() {
    const words = this.box.value.trim().toLowerCase().split(/[\s:]+/).filter(Boolean);
    const fits = ({ label, symbol: sign, path }) => words.every((word) => `${label} ${sign} ${path}`.toLowerCase().includes(word));
    this.#found = this.#fields.filter((field) => !this.#taken.has(field.path) && fits(field)).slice(0, MOST);
    this.#at = 0;
    this.list.replaceChildren(...(this.#found.length ? this.#found.map((field, place) => this.#option(field, place)) : [element("li", { class: "hint", role: "option", "aria-disabled": "true" }, "No such field.")]));
    this.list.hidden = false;
    this.box.setAttribute("aria-expanded", "true");
    this.#mark();
  }

  #option(field, place) {
    const sign = field.symbol ? element("span", { class: "field-symbol" }, ...symbol(field.symbol)) : null;
    return element(
      "li",
      { role: "option", id: `batch-field-${place}`, "data-path": field.path, title: field.path, pointerdown: (event) => event.preventDefault(), click: () => this.#take(field) },
      element("span", { class: "field-label" }, field.label),
      sign,
      element("span", { class: "form-unit" }, field.unit),
    );
  }

  #key(event) {
    const move = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (move) {
      if (this.list.hidden) return this.#show();
      this.#at = (this.#at + move + this.#found.length) % Math.max(1, this.#found.length);
      this.#mark();
    } else if (event.key === "Enter" && !this.list.hidden && this.#found.length) this.#take(this.#found[this.#at]);
    else return;
    event.preventDefault();
  }

  #mark() {
    [...this.list.children].forEach((option, place) => option.setAttribute("aria-selected", String(place === this.#at && this.#found.length > 0)));
    this.box.setAttribute("aria-activedescendant", this.#found.length ? `batch-field-${this.#at}` : "");
    this.list.children[this.#at]?.scrollIntoView({ block: "nearest" });
  }

  #take(field) {
    this.box.value = "";
    this.#close();
    this.choose(field);
  }

  #close() {
    this.list.hidden = true;
    this.box.setAttribute("aria-expanded", "false");
    this.box.setAttribute("aria-activedescendant", "");
  }
}
