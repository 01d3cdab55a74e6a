import { setText } from "../element.js";
import { fixed } from "../quantity.js";

/** The newest event and the limits at work, in words. */
export class LastEvent {
  constructor(session) {
    this.session = session;
    this.event = document.getElementById("last-event");
    this.limits = document.getElementById("limits");
    this.clock = document.getElementById("session-time");
    session.addEventListener("log", () => this.#showEvent());
    session.addEventListener("snapshot", () => this.#showLimits());
    setInterval(() => session.store.length && setText(this.clock, `${fixed(session.store.lastTime, 1)} s`), 200);
  }

  #showEvent() {
    const last = this.session.events.findLast((event) => event.number !== null);
    if (!last) return;
    const at = last.time_s === null || last.time_s === undefined ? "" : `${fixed(last.time_s, 2)} s  `;
    setText(this.event, `${at}${last.text}`);
    this.event.title = this.event.textContent;
  }

  #showLimits() {
    const { limits } = this.session.snapshot;
    setText(this.limits, limits.length ? limits.join("; ") : "none active");
    this.limits.title = this.limits.textContent;
    this.limits.classList.toggle("is-warning", limits.length > 0);
  }
}
