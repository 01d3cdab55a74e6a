import { element, setText } from "../element.js";
import { fixed } from "../quantity.js";

/**
 * What was changed, newest on top: who, when, and in which words; a click returns there. Undone changes are dim, save points
 * stand out.
 */
export class HistoryPanel {
  #lines = new Map();

  /** @param {import("./change_history.js").ChangeHistory} history */
  constructor(history) {
    this.history = history;
    this.session = history.session;
    this.undo = this.#button("Undo", "Take back the newest change, whoever made it (Ctrl+Z)", () => history.undo());
    this.redo = this.#button("Redo", "Make again what was undone (Ctrl+Shift+Z)", () => history.redo());
    this.name = element("input", {
      type: "text",
      class: "save-name",
      "aria-label": "Name of the save point",
      placeholder: "name",
      maxlength: 80,
      autocomplete: "off",
      spellcheck: "false",
    });
    this.name.addEventListener("keydown", (event) => event.key === "Enter" && this.#save());
    this.save = this.#button("Save point", "Name the present state, to return to it", () => this.#save());
    this.reset = this.#button("", "", () => this.#resetToPreset());
    this.list = element("ol", { class: "history-list" });
    this.empty = element("p", { class: "side-empty" }, "What is changed on any page will be listed here.");
    this.root = element(
      "div",
      { class: "history-panel" },
      element("div", { class: "line" }, this.undo, this.redo, this.reset),
      element("div", { class: "line" }, this.name, this.save),
      this.empty,
      this.list,
    );
    history.addEventListener("change", () => this.#show());
    this.session.document.addEventListener("change", () => this.#showButtons());
    this.#show();
  }

  #show() {
    const { entries } = this.history;
    const numbers = new Set(entries.map(({ number }) => number));
    for (const [number, { root }] of this.#lines)
      if (!numbers.has(number)) (root.remove(), this.#lines.delete(number));
    for (const entry of entries) this.#showEntry(entry);
    this.empty.hidden = entries.length > 0;
    const present = entries.findLast(({ undone, save_point }) => !undone && save_point === null) ?? entries[0];
    for (const [number, line] of this.#lines) line.root.classList.toggle("is-present", number === present?.number);
    this.#showButtons();
  }

  #showEntry(entry) {
    const text = JSON.stringify(entry);
    const known = this.#lines.get(entry.number);
    if (known?.text === text) return;
    const root = this.#line(entry);
    if (known) known.root.replaceWith(root);
    else this.list.prepend(root);
    this.#lines.set(entry.number, { text, root });
  }

  #line({ number, wall_time, time_s, by, words, undone, save_point }) {
    const when = new Date(wall_time);
    const who = by === this.session.you ? "you" : by;
    const what = save_point === null ? words.join(", ") || "back where it was" : save_point;
    const name = undone ? `${what}; undone` : what;
    const kind = save_point === null ? "" : " is-save-point";
    const title = `${when.toLocaleString()}, at ${fixed(time_s, 2)} s, ${who}${undone ? ", undone" : ""}\n${what}`;
    return element(
      "li",
      { class: `history-entry${undone ? " is-undone" : ""}${kind}`, title },
      element("time", { datetime: wall_time }, when.toLocaleTimeString([], { hour12: false })),
      element("span", { class: "history-who" }, who),
      element("span", { class: "history-words" }, save_point === null ? null : element("b", {}, "◆ "), what),
      element(
        "button",
        { type: "button", class: "quiet", "aria-label": `Return to ${name}`, click: () => this.history.returnTo(number) },
        "return",
      ),
    );
  }

  #showButtons() {
    const { history, session } = this;
    const { mayChange } = history.operator;
    this.undo.disabled = !mayChange || !history.canUndo;
    this.redo.disabled = !mayChange || !history.canRedo;
    for (const { root } of this.#lines.values()) root.querySelector("button").disabled = !mayChange;
    for (const control of [this.save, this.name]) control.disabled = !session.isConnected;
    const { preset } = session.document;
    this.reset.hidden = !preset;
    this.reset.disabled = !mayChange;
    setText(this.reset, "Reset to preset");
    this.reset.title = preset ? `Take back all changes since ${preset.name}` : "";
  }

  async #save() {
    await this.history.savePoint(this.name.value.trim());
    this.name.value = "";
  }

  async #resetToPreset() {
    const { session } = this;
    try {
      const { name, version } = session.document.preset;
      await session.command("apply_preset", { name, version });
    } catch (refusal) {
      session.note(refusal.message);
    }
  }

  #button(text, title, click) {
    return element("button", { type: "button", title, click }, text);
  }
}
