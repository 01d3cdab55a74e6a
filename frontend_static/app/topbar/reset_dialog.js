import { setText } from "../element.js";

/** Asks whether to go back to t = 0; of a rig, whether to take back a stop. Not modal: a modal dialog would make STOP inert. */
export class ResetDialog {
  #confirmed = () => {};

  constructor() {
    this.dialog = document.getElementById("reset-dialog");
    this.title = document.getElementById("reset-title");
    this.text = document.getElementById("reset-text");
    this.dialog.addEventListener("close", () => this.dialog.returnValue === "reset" && this.#confirmed());
  }

  ask(snapshot, confirmed) {
    if (this.dialog.open) return;
    this.#confirmed = confirmed;
    setText(this.title, snapshot?.rig.connected ? `Reset ${snapshot.rig.name}?` : "Reset the session?");
    if (snapshot?.rig.connected) {
      setText(this.text, "The stop, and faults whose cause is gone, are taken back. The drives stay off; then Arm again.");
      this.#open();
      return;
    }
    const then = ["stopped", "fault"].includes(snapshot?.state)
      ? "The session is then ready; start it with ▶."
      : "It starts again at once.";
    setText(this.text, `Time goes back to 0 and the plots are cleared for every page. The tuning stays. ${then}`);
    this.#open();
  }

  #open() {
    this.dialog.returnValue = "";
    this.dialog.show();
  }
}
