import { element, setText } from "../element.js";

const NOTE_MS = 12_000;

/** A sentence in a panel that says why what was asked there was refused. */
export class PanelNote {
  #timer = null;

  constructor() {
    this.root = element("p", { class: "panel-note", role: "status", hidden: true });
  }

  /** Wait for a command; say why it was refused. @returns {Promise<boolean>} whether it was carried out */
  async whileDoing(command) {
    try {
      await command;
      this.say("");
      return true;
    } catch (refusal) {
      this.say(`Refused: ${refusal.message}`);
      return false;
    }
  }

  say(text) {
    clearTimeout(this.#timer);
    setText(this.root, text);
    this.root.hidden = text === "";
    if (text) this.#timer = setTimeout(() => this.say(""), NOTE_MS);
  }
}
