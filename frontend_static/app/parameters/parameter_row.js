import { element, setText } from "../element.js";
import { describeField } from "./field_hint.js";
import { symbol } from "./symbol.js";

const NOTE_MS = 6000;

/**
 * What all parameter rows share: the name with its dot, the place for a note, the echo that waits while the row has
 * focus. Subclasses give `show(value)` and `isBusy`.
 *
 * A row's `place` says where its value lives: {path, short?, read(), write(value) -> Promise<result>, baseline()}.
 * With `restarts`, a value is sent only when the hand leaves it: each one starts the run again.
 */
export class ParameterRow {
  #noteTimer = null;
  #pending = 0;

  constructor(field, place, hint, controls) {
    this.field = field;
    this.place = place;
    this.echoed = undefined;
    this.dot = element("span", { class: "changed-dot", hidden: true }, "●");
    this.name = element(
      "span",
      { class: "row-name", id: `name-${place.path}`, dblclick: () => this.reset() },
      this.dot,
      element("span", { class: "row-title" }, place.short ?? field.title),
      field.symbol ? element("span", { class: "row-symbol" }, ...symbol(field.symbol)) : null,
    );
    this.note = element("p", { class: "row-note", role: "status", hidden: true });
    this.root = element("div", { class: "row", "data-path": place.path }, this.name, ...controls, this.note);
    this.root.addEventListener("focusout", ({ relatedTarget }) => !this.root.contains(relatedTarget) && this.#left());
    hint.attach(this.name, () => describeField(field, this.#baselineText()));
  }

  /** Take the server's value; `own` if it answers a change made here. */
  echo({ own }) {
    const value = this.place.read();
    if (value === undefined) return;
    const isNew = !this.isSame(value, this.echoed);
    this.echoed = value;
    this.#mark();
    if (this.isBusy) return;
    if (own || this.#pending || !this.root.contains(document.activeElement)) this.show(value);
    else if (isNew) this.say(`now ${this.words(value)}, set elsewhere`, "info");
  }

  words(value) {
    return String(value);
  }

  isSame(one, other) {
    return Object.is(one, other);
  }

  /** Send a value; the row then shows what the server made of it. */
  async send(value) {
    this.#pending += 1;
    this.root.classList.add("is-pending");
    try {
      const result = await this.place.write(value);
      this.say(result?.words ?? "");
      return true;
    } catch (refusal) {
      this.say(`${this.words(value)} refused: ${refusal.about?.(this.place.path) ?? refusal.message}`, "refused");
      return false;
    } finally {
      this.#pending -= 1;
      this.settle();
    }
  }

  /** Back to the preset's value, else the loaded scenario's, else the default. */
  reset() {
    const then = this.place.baseline();
    const value = then === undefined ? this.field.default : then;
    if (value !== undefined && !this.root.closest("fieldset:disabled")) this.send(value);
  }

  /** A short sentence under the row; "" removes it. @param {"info"|"warning"|"refused"} tone */
  say(text, tone = "info") {
    clearTimeout(this.#noteTimer);
    setText(this.note, text);
    this.note.hidden = text === "";
    this.root.dataset.tone = text ? tone : "";
    if (text && tone !== "refused") this.#noteTimer = setTimeout(() => this.say(""), NOTE_MS);
    if (text && tone === "refused") this.#noteTimer = setTimeout(() => this.say(""), 2 * NOTE_MS);
  }

  /** With nothing under way and no hand on it, the row shows what the server last said. */
  settle() {
    if (this.#pending || this.isBusy || this.echoed === undefined) return;
    this.root.classList.remove("is-pending");
    this.show(this.echoed);
  }

  #left() {
    if (this.root.dataset.tone === "info") this.say("");
    this.settle();
  }

  #mark() {
    const then = this.place.baseline();
    this.dot.hidden = then === undefined || this.isSame(then, this.echoed);
  }

  #baselineText() {
    const then = this.place.baseline();
    return this.dot.hidden ? "" : `Changed: was ${this.words(then)}. Double-click resets.`;
  }
}
