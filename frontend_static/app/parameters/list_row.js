import { arrange, element } from "../element.js";
import { inputText, readNumber } from "../quantity.js";
import { CommitBox } from "./commit_box.js";
import { ParameterRow } from "./parameter_row.js";
import { symbol } from "./symbol.js";

/** A list of parts of a few numbers each, such as the sines of a multi-sine: a small table with a line for each. */
export class ListRow extends ParameterRow {
  #lines = [];

  constructor(field, place, hint) {
    const heads = field.columns.map((column) =>
      element("span", { title: `${column.title}: ${column.description}` }, ...symbol(column.symbol), ` ${column.unit}`),
    );
    const head = element("div", { class: "list-line list-head", "aria-hidden": "true" }, ...heads);
    const lines = element("div", { class: "list-lines" });
    const add = element("button", { type: "button", class: "quiet list-add" }, "+ add");
    super(field, place, hint, [head, lines, add]);
    this.root.classList.add("row-list");
    this.lines = lines;
    this.add = add;
    add.setAttribute("aria-label", `Add to the ${field.title}`);
    add.addEventListener("click", () => this.#add());
  }

  get isBusy() {
    return this.#lines.some((line) => line.boxes.some((box) => box.isTyping));
  }

  isSame(one, other) {
    return JSON.stringify(one) === JSON.stringify(other);
  }

  words(value) {
    return `${value.length} ${this.field.title}`;
  }

  show(value) {
    while (this.#lines.length < value.length) this.#lines.push(this.#line(this.#lines.length));
    this.#lines.length = value.length;
    arrange(
      this.lines,
      this.#lines.map((line) => line.root),
    );
    for (const [number, part] of value.entries())
      for (const [column, { name }] of this.field.columns.entries())
        this.#lines[number].boxes[column].show(inputText(part[name]));
    this.add.hidden = value.length >= this.field.longest;
  }

  #line(number) {
    const boxes = this.field.columns.map(
      ({ name, title, unit }) =>
        new CommitBox(`${title} ${number + 1}${unit ? `, ${unit}` : ""}`, (text) => this.#change(number, name, text), {
          inputmode: "decimal",
        }),
    );
    const remove = element(
      "button",
      { type: "button", class: "quiet remove", "aria-label": `Remove ${number + 1} of the ${this.field.title}` },
      "×",
    );
    remove.addEventListener("click", () => {
      this.send(this.echoed.filter((_, each) => each !== number));
      this.add.focus();
    });
    return { boxes, root: element("div", { class: "list-line" }, ...boxes.map((box) => box.root), remove) };
  }

  async #change(number, name, text) {
    const value = readNumber(text);
    if (!Number.isFinite(value)) {
      this.settle();
      return this.say(`“${text.trim()}” is not a number`, "refused");
    }
    await this.send(this.echoed.map((part, each) => (each === number ? { ...part, [name]: value } : part)));
  }

  #add() {
    const fresh = Object.fromEntries(this.field.columns.map((column) => [column.name, column.default]));
    this.send([...this.echoed, fresh]);
  }
}
