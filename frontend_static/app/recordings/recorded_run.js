import { Samples, fetchSamples } from "./samples.js";

const MARGIN = 0.5; // of the shown span, fetched on either side of it, so that moving along shows samples at once
const POINTS_PER_PIXEL = 2; // least and greatest of each
const ENOUGH_PER_PIXEL = 1.2;
const EXACT_PER_PIXEL = 8; // so few samples a pixel are fetched one by one
const MOST_POINTS = 20_000; // that the server gives at once
const PATIENCE_MS = 50; // a drag asks for many spans
const RETRY_MS = 2000;
const AROUND = 20; // samples on either side of a cursor

/**
 * The samples of one recording, fetched as they are needed: a picture of all of it, and one of the span that is looked at.
 * Until the finer picture is there, the coarser one is shown.
 *
 * Event `change` when other samples are at hand, or when there is a problem.
 */
export class RecordedRun extends EventTarget {
  #whole = Samples.none;
  #part = null;
  #asked = null; // {from, to, points} under way
  #wanted = null;
  #timer = null;
  #channels = [];
  #abort = null;

  /** @param {object} facts answer of GET /api/recordings/{id} */
  constructor(facts) {
    super();
    this.version = 0;
    this.problem = "";
    this.take(facts);
  }

  get id() {
    return this.facts.id;
  }

  get extent() {
    return [this.facts.from_s, this.facts.to_s];
  }

  get period() {
    const [from, to] = this.extent;
    return this.facts.samples > 1 ? (to - from) / (this.facts.samples - 1) : 1e-3;
  }

  /** Newer facts of the same recording, which may have grown. */
  take(facts) {
    this.facts = facts;
    this.channels = new Map(facts.channels.map((channel) => [channel.name, channel]));
    this.version += 1;
  }

  /** Which channels to fetch from now on; others are NaN. */
  need(channels) {
    const known = channels.filter((name) => this.channels.has(name));
    if (known.every((name) => this.#channels.includes(name))) return;
    this.#channels = known;
    this.#whole = Samples.none;
    this.#part = null;
    this.version += 1;
  }

  /** @returns {Samples} the best picture at hand of a span; a better one is asked for if there can be one */
  picture([from, to], pixels) {
    const [first, last] = this.extent;
    const span = [Math.max(from, first), Math.min(to, last)];
    if (!(span[1] > span[0]) || !this.#channels.length) return this.#whole;
    const best = [this.#part, this.#whole].find((each) => each && covers(each, span)) ?? this.#whole;
    if (!this.#isFine(best, span, pixels)) this.#want(span, pixels);
    return best;
  }

  /** @returns {Promise<Samples|null>} every sample near a time */
  async around(time) {
    const reach = AROUND * this.period;
    const span = { from_s: time - reach, to_s: time + reach, points: 4 * AROUND };
    return fetchSamples(this.id, { channels: this.#channels, ...span }).catch(() => null);
  }

  #isFine(samples, [from, to], pixels) {
    if (!covers(samples, [from, to])) return false;
    const own = samples.asked;
    return samples.isExact || (own.points * (to - from)) / (own.to - own.from) >= ENOUGH_PER_PIXEL * pixels;
  }

  #want([from, to], pixels) {
    const [first, last] = this.extent;
    const isWhole = from <= first && to >= last;
    const margin = isWhole ? 0 : MARGIN * (to - from);
    const span = { from: Math.max(first, from - margin), to: Math.min(last, to + margin) };
    const share = (span.to - span.from) / (to - from);
    const samples = Math.ceil((span.to - span.from) / this.period) + 2;
    const few = samples <= Math.min(MOST_POINTS - 2, share * EXACT_PER_PIXEL * pixels);
    const points = few ? samples + 2 : Math.ceil(share * POINTS_PER_PIXEL * pixels);
    this.#wanted = { ...span, points: Math.max(4, Math.min(MOST_POINTS, points)), isWhole };
    if (this.#asked && covers({ asked: this.#asked }, [from, to]) && this.#asked.points >= this.#wanted.points / 2) return;
    this.#timer ??= setTimeout(() => this.#fetch(), this.#whole.time.length ? PATIENCE_MS : 0);
  }

  async #fetch() {
    this.#timer = null;
    this.#abort?.abort();
    const abort = (this.#abort = new AbortController());
    const asked = (this.#asked = this.#wanted);
    try {
      const { from: from_s, to: to_s, points } = asked;
      const samples = await fetchSamples(this.id, { channels: this.#channels, from_s, to_s, points }, abort.signal);
      samples.asked = asked;
      if (asked.isWhole) this.#whole = samples;
      else this.#part = samples;
      this.#tell("");
    } catch (error) {
      if (abort.signal.aborted) return;
      this.#tell(`${this.facts.name || this.id} cannot be read: ${error.message}`);
      await new Promise((resolve) => setTimeout(resolve, RETRY_MS));
    } finally {
      if (this.#asked === asked) this.#asked = null;
    }
    this.version += 1;
  }

  #tell(problem) {
    this.problem = problem;
    this.version += 1;
    this.dispatchEvent(new Event("change"));
  }
}

function covers({ asked }, [from, to]) {
  return Boolean(asked) && asked.from <= from + 1e-9 && asked.to >= to - 1e-9;
}
