import { element } from "../element.js";
import { KEYS, ROW_KEYS } from "../keys.js";

/** All keys, from the same table as the bindings. Not modal: a modal dialog would make STOP inert. */
export class KeysDialog {
  constructor() {
    this.dialog = document.getElementById("keys-dialog");
    const rows = [...KEYS, ...ROW_KEYS].map(({ shown, text }) => [
      element("dt", {}, element("kbd", {}, shown)),
      element("dd", {}, text),
    ]);
    document.getElementById("keys-list").append(...rows.flat());
    document.getElementById("show-keys").addEventListener("click", () => this.show());
  }

  show() {
    if (!this.dialog.open) this.dialog.show();
  }
}
