import { element } from "../element.js";

/**
 * A text that is changed where it stands: committed on Enter or when it is left, given back on Ctrl+Z of the browser.
 * While it is being changed it ignores what the server says.
 */
export class EditableText {
  #shown = "";

  /** @param {string} label @param {(text: string, begun: any) => Promise<boolean>} commit returns whether it was kept; `begun`
   *  is what `begin` returned when the text was entered */
  constructor(label, commit, { begin = () => null, placeholder = "", isLong = false, maxlength = 80 } = {}) {
    const attributes = { "aria-label": label, placeholder, maxlength, autocomplete: "off", class: "editable" };
    this.box = isLong
      ? element("textarea", { ...attributes, rows: 1, input: () => this.#fit() })
      : element("input", { ...attributes, type: "text", spellcheck: "false" });
    this.root = this.box;
    this.box.addEventListener("change", async () => {
      const text = this.box.value.trim();
      if (text !== this.#shown && (await commit(text, this.begun))) this.#shown = text;
    });
    this.box.addEventListener("focus", () => (this.begun = begin()));
    this.box.addEventListener("keydown", (event) => event.key === "Enter" && !event.shiftKey && this.#leave(event));
  }

  get isBeingChanged() {
    return document.activeElement === this.box && this.box.value.trim() !== this.#shown;
  }

  show(text) {
    const isChanged = this.isBeingChanged;
    this.#shown = text;
    if (!isChanged && this.box.value !== text) this.box.value = text;
    this.#fit();
  }

  #leave(event) {
    event.preventDefault();
    this.box.blur();
  }

  #fit() {
    if (this.box.tagName !== "TEXTAREA") return;
    this.box.style.height = "auto";
    this.box.style.height = `${this.box.scrollHeight + 2}px`;
  }
}
