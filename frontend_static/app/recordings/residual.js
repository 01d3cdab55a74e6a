import { firstAtOrAfter } from "../session/telemetry_store.js";
import { fetchSamples } from "./samples.js";

const MOST_SAMPLES = 100_000; // of a span whose residual is drawn
const AT_ONCE = 15_000; // samples of one request
const MOST_POINTS = 20_000; // that the server gives at once
const PATIENCE_MS = 150;
const PREFIX = "residual ";

/**
 * What remains of some signals of a recording when the simulation of the same scenario is taken away; computed from every
 * sample of the shown span, so it is drawn where that span is short enough.
 *
 * Event `change`.
 */
export class Residual extends EventTarget {
  #spans = null;
  #asked = "";

  /** @param {import("./recorded_run.js").RecordedRun} run @param {string} other id of the simulation @param {string[]} channels */
  constructor(run, other, channels) {
    super();
    this.run = run;
    this.other = other;
    this.channels = channels;
    this.version = 0;
    this.problem = "";
  }

  static nameOf(channel) {
    return PREFIX + channel;
  }

  /** Put the residuals into a picture: themselves where it is exact, else least and greatest. */
  fill(picture, [from, to]) {
    this.#want(from, to);
    if (picture.residual === this.version) return;
    picture.residual = this.version;
    for (const channel of this.channels) picture.add(Residual.nameOf(channel), this.#along(picture, channel));
  }

  #along({ time, isExact }, channel) {
    const values = new Float32Array(time.length).fill(NaN);
    const own = this.#spans?.values.get(channel);
    if (!own) return values;
    const { time: times } = this.#spans;
    const step = isExact ? 1 : 2;
    for (let i = 0; i < time.length; i += step) {
      const end = i + step < time.length ? time[i + step] : Infinity;
      const start = firstAtOrAfter(times, time[i] - 1e-6);
      if (isExact) values[i] = Math.abs(times[start] - time[i]) < 1e-6 ? own[start] : NaN;
      else [values[i], values[i + 1]] = extremes(times, own, start, end);
    }
    return values;
  }

  #want(from, to) {
    const [first, last] = this.run.extent;
    const span = { from_s: Math.max(first, from), to_s: Math.min(last, to) };
    const asked = `${span.from_s} ${span.to_s}`;
    if (asked === this.#asked) return;
    this.#asked = asked;
    clearTimeout(this.timer);
    const samples = Math.ceil((span.to_s - span.from_s) / this.run.period) + 4;
    if (samples > MOST_SAMPLES) {
      const seconds = Math.floor(MOST_SAMPLES * this.run.period);
      return this.#tell(null, `The residual is drawn of at most ${seconds} s: zoom in.`);
    }
    this.timer = setTimeout(() => this.#fetch(asked, span), PATIENCE_MS);
  }

  async #fetch(asked, { from_s, to_s }) {
    const step = AT_ONCE * this.run.period;
    const parts = [];
    try {
      for (let begin = from_s; begin < to_s && asked === this.#asked; begin += step) {
        const span = { from_s: begin, to_s: Math.min(to_s, begin + step), channels: this.channels, points: MOST_POINTS };
        const [one, other] = await Promise.all([this.run.id, this.other].map((id) => fetchSamples(id, span)));
        parts.push(differences(one, other, this.channels));
      }
      if (asked === this.#asked) this.#tell(joined(parts, this.channels), "");
    } catch (error) {
      if (asked === this.#asked) this.#tell(null, `The residual cannot be drawn: ${error.message}`);
    }
  }

  #tell(spans, problem) {
    this.#spans = spans;
    this.problem = problem;
    this.version += 1;
    this.dispatchEvent(new Event("change"));
  }
}

/** Sample by sample, where both have one at the same time. */
function differences(one, other, channels) {
  const at = Int32Array.from(one.time, (time) => {
    const near = firstAtOrAfter(other.time, time - 1e-6);
    return Math.abs(other.time[near] - time) < 1e-6 ? near : -1;
  });
  const values = channels.map((channel) => {
    const [a, b] = [one.column(channel), other.column(channel)];
    return [channel, Float32Array.from(at, (near, i) => (near < 0 ? NaN : a[i] - b[near]))];
  });
  return { time: one.time, values: new Map(values) };
}

function joined(parts, channels) {
  const length = parts.reduce((sum, { time }) => sum + time.length, 0);
  const join = (arrays, into) => {
    arrays.reduce((at, array) => (into.set(array, at), at + array.length), 0);
    return into;
  };
  const values = channels.map((name) => [name, join(parts.map((part) => part.values.get(name)), new Float32Array(length))]);
  return { time: join(parts.map(({ time }) => time), new Float64Array(length)), values: new Map(values) };
}

function extremes(times, values, start, end) {
  let [low, high] = [Infinity, -Infinity];
  for (let i = start; i < times.length && times[i] < end; i += 1) {
    if (values[i] < low) low = values[i];
    if (values[i] > high) high = values[i];
  }
  return low <= high ? [low, high] : [NaN, NaN];
}
