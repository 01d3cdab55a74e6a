import { element, setText } from "../element.js";

const HINT = 'name = "bench"\n# the rest of its file; the command\n# vssea rig example writes one';

/** A place to paste a rig's file. What is refused stays in it, with the reason. */
export class RigAdd {
  /** @param {import("./rigs.js").Rigs} rigs @param {(name: string) => void} added */
  constructor(rigs, added) {
    Object.assign(this, { rigs, added });
    this.text = element("textarea", { rows: 7, spellcheck: "false", placeholder: HINT, "aria-label": "The rig’s file, TOML" });
    this.button = element("button", { type: "button", click: () => this.#add() }, "Keep it");
    this.problem = element("p", { class: "rig-note", role: "status", hidden: true });
    this.root = element(
      "details",
      { class: "rig-add" },
      element("summary", {}, "Add a rig, or change its file"),
      this.text,
      this.problem,
      element("div", { class: "rig-row" }, this.button),
    );
  }

  /** Put a file here to be changed. */
  show(text) {
    this.text.value = text;
    this.root.open = true;
    this.#say("");
    this.text.focus();
  }

  async #add() {
    const name = /^\s*name\s*=\s*["'](.+?)["']/m.exec(this.text.value)?.[1];
    if (!name) return this.#say("The file has no line such as: name = \"bench\".");
    try {
      await this.rigs.keep(name, this.text.value);
    } catch (refusal) {
      return this.#say(refusal.message);
    }
    this.#say("");
    this.text.value = "";
    this.root.open = false;
    return this.added(name);
  }

  #say(text) {
    setText(this.problem, text);
    this.problem.hidden = text === "";
  }
}
