import { element, setText } from "../element.js";
import { fieldsNamed } from "../document/changeable_fields.js";
import { inputText, readNumber } from "../quantity.js";
import { CommitBox } from "./commit_box.js";

/** One timed change in the making: when, which field, what it becomes. */
export class SequenceLine {
  /** @param {import("./sequence_panel.js").SequencePanel} panel @param {string} fieldsId of the list of names
   *  @param {{at_s: number, path: string, value: any}} value */
  constructor(panel, fieldsId, value) {
    this.panel = panel;
    this.value = value;
    this.wrong = "";
    this.at = new CommitBox("", (text) => this.#takeTime(text), { inputmode: "decimal", class: "sequence-at" });
    this.name = new CommitBox("", (text) => this.#takeName(text), {
      list: fieldsId,
      placeholder: "field: type to search",
      class: "sequence-field",
    });
    this.name.root.addEventListener("focus", () => panel.offer(this));
    this.name.root.addEventListener("input", () => this.#noticeChosen());
    this.target = element("div", { class: "sequence-target" });
    this.problem = element("p", { class: "panel-note", role: "status", hidden: true });
    this.gone = element("button", { type: "button", class: "quiet remove", click: () => panel.remove(this) }, "×");
    this.root = element(
      "div",
      { class: "sequence-line", role: "group" },
      this.at.root,
      element("span", { class: "row-unit" }, "s"),
      this.name.root,
      this.gone,
      this.target,
      this.problem,
    );
    this.#show();
  }

  get field() {
    return this.name.root;
  }

  /** Say which change this is, for screen readers. */
  number(count) {
    this.root.setAttribute("aria-label", `Change ${count}`);
    this.at.root.setAttribute("aria-label", `Change ${count}: time, s`);
    this.name.root.setAttribute("aria-label", `Change ${count}: field`);
    this.gone.setAttribute("aria-label", `Remove change ${count}`);
    this.target.querySelector("input, select")?.setAttribute("aria-label", `Change ${count}: new value`);
  }

  /** @returns {boolean} whether it is complete; if not, it says what is missing */
  check() {
    if (!this.value.path) this.#say("Choose a field from the list.", this.name);
    else if (this.wrong) this.#say(this.wrong);
    return Boolean(this.value.path) && !this.wrong;
  }

  focus() {
    (this.value.path ? (this.target.querySelector("input, select") ?? this.at.root) : this.name.root).focus();
  }

  #takeTime(text) {
    const at = readNumber(text);
    if (!(at >= 0)) return this.#say(`“${text.trim()}” is no time; expected 0 s or more`, this.at);
    this.value = { ...this.value, at_s: at };
    this.#changed();
  }

  /** A name clicked in the list is complete. */
  #noticeChosen() {
    const text = this.name.root.value;
    if (this.panel.fieldsAt(this).some(({ label }) => label === text)) this.#takeName(text);
  }

  #takeName(text) {
    const found = fieldsNamed(text, this.panel.fieldsAt(this));
    if (found.length !== 1) {
      this.wrong = found.length
        ? `“${text.trim()}” may be ${found.length} fields; choose one from the list`
        : `There is no field “${text.trim()}”; choose one from the list`;
      return this.#say(this.wrong, this.name);
    }
    const [{ path }] = found;
    if (path !== this.value.path) this.value = { ...this.value, path, value: this.panel.valueAt(this, path) };
    this.#changed();
  }

  #takeValue(box, text, { low, high, unit, isNullable }) {
    const value = isNullable && text.trim() === "" ? null : readNumber(text);
    const range = Number.isFinite(low + high) ? ` from ${inputText(low)} to ${inputText(high)} ${unit}` : "";
    const isFit = value === null || (value >= low && value <= high);
    this.wrong = isFit ? "" : `“${text.trim()}” refused: expected a number${range}`;
    if (this.wrong) return this.#say(this.wrong, box);
    this.value = { ...this.value, value };
    this.#changed();
  }

  #changed() {
    this.wrong = "";
    this.#show();
    this.panel.changed();
  }

  #show() {
    this.#say("");
    const field = this.value.path && this.panel.fieldsAt(this).find(({ path }) => path === this.value.path);
    this.at.show(inputText(this.value.at_s));
    this.name.show(field ? field.label : this.value.path);
    this.name.root.title = this.value.path;
    this.target.hidden = !this.value.path;
    if (this.value.path) this.target.replaceChildren(...this.#control(field));
  }

  #control(field) {
    const { value } = this.value;
    const arrow = element("span", { class: "row-unit" }, "becomes");
    if (field?.options) {
      const options = field.options.map((option) => new Option(option.text, String(option.value)));
      const select = element("select", {}, ...options);
      select.value = String(value);
      select.addEventListener("change", () => {
        this.value = { ...this.value, value: field.options[select.selectedIndex].value };
        this.#changed();
      });
      return [arrow, select];
    }
    if (!field || (typeof value === "object" && value !== null)) return [arrow, element("span", {}, this.#asItIs())];
    const take = (text) => this.#takeValue(box, text, field);
    const box = new CommitBox("", take, { inputmode: "decimal", placeholder: field.isNullable ? "none" : null });
    box.show(inputText(value));
    return [arrow, box.root, element("span", { class: "row-unit" }, field?.unit ?? "")];
  }

  /** A value that this page cannot edit is kept. */
  #asItIs() {
    const { value } = this.value;
    return typeof value === "object" ? "as the scenario has it" : String(value);
  }

  #say(text, box) {
    setText(this.problem, text);
    this.problem.hidden = text === "";
    box?.refused(Boolean(text));
  }
}
