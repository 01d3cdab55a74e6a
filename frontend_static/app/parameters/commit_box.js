import { element } from "../element.js";

/** A text box that asks for what was typed at Enter or when it is left, and ignores echoes while someone types. */
export class CommitBox {
  /** @param {string} label for screen readers @param {(text: string) => void} commit called only if something was typed
   *  @param {object} [attributes] more of the element's */
  constructor(label, commit, attributes = {}) {
    this.isTyping = false;
    this.commit = commit;
    this.root = element("input", {
      type: "text",
      autocomplete: "off",
      spellcheck: "false",
      "aria-label": label,
      focus: () => this.root.select(),
      input: () => {
        this.isTyping = true;
        this.refused(false);
      },
      blur: () => this.#take(),
      keydown: (event) => event.key === "Enter" && this.#take(),
      ...attributes,
    });
  }

  show(text) {
    if (this.isTyping) return;
    this.root.value = text;
    this.refused(false);
  }

  refused(isRefused) {
    if (isRefused) this.root.setAttribute("aria-invalid", "true");
    else this.root.removeAttribute("aria-invalid");
  }

  #take() {
    if (!this.isTyping) return;
    this.isTyping = false;
    this.commit(this.root.value);
  }
}
