import { rest } from "../session/rest.js";

const PATIENCE_MS = 250;

/**
 * STOP: never disabled, never asks. It goes over the websocket; without an answer in a quarter of a second, or without a
 * connection, also over REST.
 */
export class StopButton {
  /** @param {import("../session/live_session.js").LiveSession} session @param {import("../session/jog.js").Jog} jog */
  constructor(session, jog) {
    this.session = session;
    this.jog = jog;
    this.button = document.getElementById("stop");
    this.button.addEventListener("click", () => this.press());
  }

  async press() {
    this.button.classList.add("is-pressed");
    setTimeout(() => this.button.classList.remove("is-pressed"), 400);
    const answered = this.session.command("stop").then(
      () => true,
      () => false,
    );
    this.jog.end();
    const late = new Promise((resolve) => setTimeout(() => resolve(false), this.session.isConnected ? PATIENCE_MS : 0));
    if (await Promise.race([answered, late])) return;
    try {
      await rest("POST", "/api/session/stop", {});
    } catch {
      if (!(await answered)) this.session.note("STOP did not reach the server. Use the hardware stop.", "fault");
    }
  }
}
