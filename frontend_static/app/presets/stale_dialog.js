import { element, setText } from "../element.js";

/** Asks what to do about a preset that others have changed since this page knew it. Not modal: STOP must work. */
export class StaleDialog {
  #resolve = null;

  constructor() {
    this.text = element("p", {});
    this.save = element("button", { type: "button", class: "confirm", click: () => this.#answer(true) }, "Save mine on top");
    this.dialog = element(
      "dialog",
      { id: "stale-dialog", "aria-labelledby": "stale-title" },
      element("h2", { id: "stale-title" }, "Changed meanwhile"),
      this.text,
      element("menu", {}, element("button", { type: "button", click: () => this.#answer(false) }, "Leave theirs"), this.save),
    );
    this.dialog.addEventListener("close", () => this.#answer(false));
    document.body.append(this.dialog);
  }

  /** @returns {Promise<boolean>} whether to save all the same; both versions are kept */
  ask(words) {
    this.#resolve?.(false);
    setText(this.text, `${words} Save what runs as a version after it? Theirs stays as a version.`);
    this.dialog.show();
    this.save.focus();
    return new Promise((resolve) => (this.#resolve = resolve));
  }

  #answer(isSave) {
    const resolve = this.#resolve;
    this.#resolve = null;
    if (this.dialog.open) this.dialog.close();
    resolve?.(isSave);
  }
}
