import { setText } from "../element.js";

/** The one question the page asks: whether to go back to t = 0. Not modal: a modal dialog would make STOP inert. */
export class ResetDialog {
  #confirmed = () => {};

  constructor() {
    this.dialog = document.getElementById("reset-dialog");
    this.text = document.getElementById("reset-text");
    this.dialog.addEventListener("close", () => this.dialog.returnValue === "reset" && this.#confirmed());
  }

  ask(snapshot, confirmed) {
    if (this.dialog.open) return;
    this.#confirmed = confirmed;
    const then = ["stopped", "fault"].includes(snapshot?.state)
      ? "The session is then ready; start it with ▶."
      : "It starts again at once.";
    setText(this.text, `Time goes back to 0 and the plots are cleared for every page. The tuning stays. ${then}`);
    this.dialog.returnValue = "";
    this.dialog.show();
  }
}
