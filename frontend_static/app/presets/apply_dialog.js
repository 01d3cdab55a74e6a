import { element, setText } from "../element.js";
import { DifferenceTable, changesText } from "./difference_table.js";

/** Asks before a preset changes what runs: what differs, which of it, then one button. Not modal: STOP must work. */
export class ApplyDialog {
  constructor() {
    this.title = element("h2", { id: "apply-title" });
    this.table = new DifferenceTable(true);
    this.table.addEventListener("change", () => this.#say());
    this.button = element("button", { type: "button", class: "start", click: () => this.#answer(this.table.isWhole ? null : this.table.chosen) });
    this.dialog = element(
      "dialog",
      { id: "apply-dialog", class: "apply-dialog", "aria-labelledby": "apply-title" },
      this.title,
      this.table.root,
      element("menu", {}, element("button", { type: "button", click: () => this.#answer(undefined) }, "Cancel"), this.button),
    );
    this.dialog.addEventListener("close", () => this.#answer(undefined));
    document.body.append(this.dialog);
  }

  /** @returns {Promise<string[]|null|undefined>} the chosen paths, null for all of it, undefined for none */
  ask(name, difference) {
    this.#resolve?.(undefined);
    setText(this.title, `Apply ${name}?`);
    this.table.show(difference, "runs now", "preset");
    this.refused = difference.refused.length > 0;
    this.#say();
    this.dialog.show();
    this.button.focus();
    return new Promise((resolve) => (this.#resolve = resolve));
  }

  #resolve = null;

  #say() {
    const count = this.table.chosen.length;
    this.button.disabled = count === 0;
    setText(this.button, `Apply ${changesText(count)}`);
  }

  #answer(paths) {
    const resolve = this.#resolve;
    this.#resolve = null;
    if (this.dialog.open) this.dialog.close();
    resolve?.(paths === null && this.refused ? this.table.chosen : paths);
  }
}
