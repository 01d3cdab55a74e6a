import { element, setText } from "../element.js";

/** A heading that opens and closes what is below it, and says in a word what is there while it is closed. */
export class Fold {
  /** @param {string} title @param {HTMLElement} body with an id */
  constructor(title, body) {
    this.body = body;
    this.note = element("span", { class: "hint" });
    this.button = element("button", { type: "button", class: "fold", "aria-controls": body.id, click: () => this.open(this.body.hidden) }, title, this.note);
    this.root = element("h2", {}, this.button);
    this.open(true);
  }

  open(isOpen) {
    this.body.hidden = !isOpen;
    this.button.setAttribute("aria-expanded", String(isOpen));
  }

  /** @param {string} words beside the title */
  say(words) {
    setText(this.note, words);
  }
}
