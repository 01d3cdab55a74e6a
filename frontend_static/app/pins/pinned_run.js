import { Samples, fetchSamples } from "../recordings/samples.js";

const POINTS = 20_000; // every sample of the usual spans: what is thinned looks solid where it should be dashed
const RETRY_MS = 1000;
const LONGEST_RETRY_MS = 15_000;
const TRIES = 6; // the newest samples of a recording reach the disk a moment later
const LATE_S = 0.1;

/** One pinned run: what the server says of it, and its samples once it is shown. Event `change`. */
export class PinnedRun extends EventTarget {
  #isAsked = false;

  constructor(excerpt, channels) {
    super();
    this.excerpt = excerpt;
    this.channels = channels;
    this.samples = Samples.none;
    this.problem = "";
  }

  get id() {
    return this.excerpt.id;
  }

  get seconds() {
    return this.excerpt.to_s - this.excerpt.from_s;
  }

  /** Take what the server says of it now. */
  take(excerpt) {
    this.excerpt = excerpt;
    if (excerpt.shown && !this.#isAsked) this.#fetch();
  }

  /** Let go of it. */
  end() {
    this.excerpt = { ...this.excerpt, shown: false };
  }

  async #fetch() {
    this.#isAsked = true;
    let wait = RETRY_MS;
    for (let left = TRIES; left > 0 && this.excerpt.shown; wait = Math.min(2 * wait, LONGEST_RETRY_MS)) {
      if (await this.#fetchOnce()) left -= 1;
      if (this.samples.time.at(-1) >= this.excerpt.to_s - LATE_S) return;
      await new Promise((resolve) => setTimeout(resolve, wait));
    }
    this.#isAsked = false; // tried again when it is hidden and shown
  }

  /** @returns {Promise<boolean>} whether the server had an answer */
  async #fetchOnce() {
    const { recording, from_s, to_s } = this.excerpt;
    if (recording === null) {
      this.#tell("it was not recorded");
      return true;
    }
    try {
      this.samples = await fetchSamples(recording, { channels: this.channels, from_s, to_s, points: POINTS });
      this.#tell("");
      return true;
    } catch (refusal) {
      this.#tell(refusal.message);
      return refusal.problem?.status === 404;
    }
  }

  #tell(problem) {
    this.problem = problem;
    this.dispatchEvent(new Event("change"));
  }
}
