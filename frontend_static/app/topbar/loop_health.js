import { setText } from "../element.js";
import { fixed } from "../quantity.js";

/** How well the control loop keeps its time, what was lost on the way here, and who is here. */
export class LoopHealth {
  constructor(session) {
    this.session = session;
    this.rate = document.getElementById("loop-rate");
    this.lateness = document.getElementById("loop-lateness");
    this.overruns = document.getElementById("loop-overruns");
    this.lost = document.getElementById("lost-samples");
    this.line = document.getElementById("loop-health");
    this.pages = document.getElementById("pages");
    session.addEventListener("snapshot", () => this.#show());
  }

  #show() {
    const { loop, pages, pace } = this.session.snapshot;
    const { lostSamples } = this.session.store;
    setText(this.rate, `${fixed(loop.rate_hz / 1000, loop.rate_hz % 1000 ? 2 : 0)} kHz`);
    setText(this.lateness, `p99 ${fixed(loop.lateness_us?.p99, 0)} µs`);
    setText(this.overruns, `${loop.overruns} overrun${loop.overruns === 1 ? "" : "s"}`);
    setText(this.lost, `${lostSamples} lost`);
    this.overruns.classList.toggle("is-warning", loop.overruns > 0);
    this.lost.classList.toggle("is-warning", lostSamples > 0);
    this.line.title = [
      `Loop at ${loop.rate_hz} Hz, ${loop.scheduling}`,
      `wakes late by ${spread(loop.lateness_us)}`,
      `computes for ${spread(loop.execution_us)}`,
      `${loop.overruns} periods overrun`,
      `${lostSamples} samples did not reach this page`,
      `real-time factor ${fixed(pace.achieved, 3)} of ${pace.asked} asked`,
    ].join("\n");
    setText(this.pages, pages > 1 ? `${this.session.you}, ${pages} open` : this.session.you);
    this.pages.title =
      pages > 1
        ? `You are ${this.session.you}; ${pages} pages are open on this session, all may tune and stop`
        : "You are the only page on this session";
  }
}

function spread(times) {
  return times
    ? `${fixed(times.p50, 0)} / ${fixed(times.p99, 0)} / ${fixed(times.worst, 0)} µs (p50 / p99 / worst)`
    : "unknown";
}
