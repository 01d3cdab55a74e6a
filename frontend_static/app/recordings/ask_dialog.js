import { element, setText } from "../element.js";

/** Asks one question, with a line or a text to fill in if wanted. Not modal: a modal dialog would make STOP inert. */
export class AskDialog {
  #answer = () => {};

  constructor() {
    this.title = element("h2", { id: "ask-title" });
    this.text = element("p");
    this.box = element("input", { type: "text", maxlength: 120, autocomplete: "off", hidden: true });
    this.area = element("textarea", { rows: 5, maxlength: 4000, hidden: true });
    this.confirm = element("button", { value: "yes" });
    this.dialog = element(
      "dialog",
      { class: "ask-dialog", "aria-labelledby": "ask-title", close: () => this.#answer(this.dialog.returnValue === "yes") },
      element(
        "form",
        { method: "dialog" },
        this.title,
        this.text,
        this.box,
        this.area,
        element("menu", {}, element("button", { type: "button", click: () => this.dialog.close("") }, "Cancel"), this.confirm),
      ),
    );
    document.body.append(this.dialog);
  }

  /** @returns {Promise<boolean>} whether it was confirmed */
  async sure(title, text, confirm) {
    return (await this.#ask(title, text, confirm, null, true)) !== null;
  }

  /** @returns {Promise<string|null>} what was written, null if it was cancelled */
  async line(title, value, confirm) {
    return this.#ask(title, "", confirm, { field: this.box, value });
  }

  /** @returns {Promise<string|null>} what was written, null if it was cancelled */
  async note(title, value, confirm) {
    return this.#ask(title, "", confirm, { field: this.area, value });
  }

  #ask(title, text, confirm, filled, isGrave = false) {
    if (this.dialog.open) this.dialog.close("");
    setText(this.title, title);
    setText(this.text, text);
    this.text.hidden = text === "";
    setText(this.confirm, confirm);
    this.confirm.classList.toggle("confirm", isGrave);
    for (const field of [this.box, this.area]) {
      field.hidden = field !== filled?.field;
      field.setAttribute("aria-label", title);
    }
    this.dialog.returnValue = "";
    const before = document.activeElement;
    this.dialog.show();
    if (filled) filled.field.value = filled.value;
    (filled?.field ?? this.confirm).focus();
    return new Promise((resolve) => {
      this.#answer = (isYes) => {
        before?.focus?.();
        resolve(isYes ? (filled?.field.value ?? "") : null);
      };
    });
  }
}
