import { PinnedRun } from "./pinned_run.js";

/**
 * The runs that are pinned beside the live one, and what triggers captured, as the server keeps them.
 *
 * Event `change`.
 */
export class PinnedRuns extends EventTarget {
  #runs = new Map();

  /** @param {import("../session/live_session.js").LiveSession} session @param {string[]} channels to draw of each */
  constructor(session, channels) {
    super();
    this.session = session;
    this.channels = channels;
    this.version = 0;
    session.connection.addEventListener("message", ({ detail }) => {
      if (detail.type === "pins" || (detail.type === "hello" && detail.pins)) this.#take(detail.pins);
    });
  }

  /** @returns {PinnedRun[]} oldest first */
  get list() {
    return [...this.#runs.values()];
  }

  /** Pin a span of the present run. @param {[number, number]} range s @param {boolean} endsNow */
  pin([from, to], endsNow) {
    const seconds = Math.max(0.1, Math.min(60, to - Math.max(0, from)));
    return this.#ask("pin", endsNow ? { seconds } : { seconds, to_s: to });
  }

  rename(run, label) {
    return this.#ask("change_pin", { id: run.id, label });
  }

  show(run, shown) {
    return this.#ask("change_pin", { id: run.id, shown });
  }

  letGo(run) {
    return this.#ask("unpin", { id: run.id });
  }

  #take(excerpts) {
    const before = this.#runs;
    this.#runs = new Map();
    for (const excerpt of excerpts) {
      const run = before.get(excerpt.id) ?? this.#made(excerpt);
      run.take(excerpt);
      this.#runs.set(excerpt.id, run);
    }
    for (const [id, run] of before) if (!this.#runs.has(id)) run.end();
    this.#changed();
  }

  #made(excerpt) {
    const run = new PinnedRun(excerpt, this.channels);
    run.addEventListener("change", () => this.#changed());
    return run;
  }

  #changed() {
    this.version += 1;
    this.dispatchEvent(new Event("change"));
  }

  async #ask(command, args) {
    try {
      await this.session.command(command, args);
    } catch (refusal) {
      this.session.note(refusal.message);
    }
  }
}
