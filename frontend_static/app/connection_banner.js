import { setText } from "./element.js";

/** Says that the connection is lost, why, and when the next attempt is. */
export class ConnectionBanner {
  constructor(session) {
    this.session = session;
    this.banner = document.getElementById("connection-banner");
    this.why = document.getElementById("connection-why");
    this.countdown = document.getElementById("connection-countdown");
    document.getElementById("connection-retry").addEventListener("click", () => session.start());
    session.addEventListener("connection", () => this.#show());
  }

  #show() {
    const { loss } = this.session;
    clearInterval(this.ticking);
    this.banner.hidden = !loss;
    document.body.dataset.connection = loss ? "lost" : "open";
    if (!loss) return;
    setText(this.why, `Connection lost. ${loss.why} Plots and values are old; STOP is tried over REST.`);
    this.#count();
    this.ticking = setInterval(() => this.#count(), 200);
  }

  #count() {
    const { retryAt } = this.session.loss ?? {};
    const left = retryAt === null ? 0 : Math.ceil((retryAt - performance.now()) / 1000);
    setText(this.countdown, left > 0 ? `Next attempt in ${left} s` : "Connecting…");
  }
}
