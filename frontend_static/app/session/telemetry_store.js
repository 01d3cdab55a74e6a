const RESTART_SAMPLES = 1000; // live data so far back come from another run of the server

/**
 * The last minute of telemetry: one sliding typed array a channel, handed out as views.
 *
 * The arrays are twice as long as what is kept; when they are full, the newer half moves to the front. Lost samples
 * become one row of NaN, so that a line is broken there and never drawn across.
 */
export class TelemetryStore extends EventTarget {
  #time;
  #columns = new Map();
  #rows = new Map();
  #begin = 0;
  #end = 0;
  #nextSequence = null;

  /** @param {string[]} channels names to keep @param {number} retain samples kept at least */
  constructor(channels, retain = 66_000) {
    super();
    this.retain = retain;
    this.#time = new Float64Array(2 * retain);
    for (const name of channels) this.#columns.set(name, new Float32Array(2 * retain));
    this.epoch = null;
    this.lostSamples = 0;
    this.version = 0;
  }

  /** Learn at which row of a frame each kept channel lies. @param {{name: string}[]} channels the server's list */
  readChannels(channels) {
    this.#rows = new Map(channels.map((channel, row) => [channel.name, row]));
  }

  get length() {
    return this.#end - this.#begin;
  }

  get time() {
    return this.#time.subarray(this.#begin, this.#end);
  }

  get lastTime() {
    return this.length ? this.#time[this.#end - 1] : 0;
  }

  has(name) {
    return this.#columns.has(name);
  }

  /** @returns {Float32Array} view of the kept samples of a channel, as long as `time` */
  column(name) {
    return this.#columns.get(name).subarray(this.#begin, this.#end);
  }

  /** @returns {number} newest sample of a channel, NaN if there is none */
  latest(name) {
    if (name === "time") return this.length ? this.lastTime : NaN;
    return this.length && this.has(name) ? this.#columns.get(name)[this.#end - 1] : NaN;
  }

  /** A copy of everything kept, for a picture that stands still while the recording goes on. */
  copy() {
    const columns = new Map([...this.#columns.keys()].map((name) => [name, this.column(name).slice()]));
    return { time: this.time.slice(), column: (name) => columns.get(name) };
  }

  /** Forget all samples; with `restarted` also where the sequence stood (another run of the server). */
  clear({ restarted = false } = {}) {
    this.#begin = this.#end = 0;
    this.version += 1;
    this.dispatchEvent(new Event("cleared"));
    if (!restarted) return;
    this.#nextSequence = null;
    this.epoch = null;
  }

  /** Append what is new in a frame. @param {import("./telemetry_frame.js").TelemetryFrame} frame */
  accept(frame) {
    const behind = this.#nextSequence === null ? -1 : this.#nextSequence - frame.nextSequence;
    if (frame.isHistory && behind >= 0) return;
    const restarted = behind > RESTART_SAMPLES;
    if (restarted || (this.epoch !== null && frame.epoch !== this.epoch)) this.clear({ restarted: true });
    this.epoch = frame.epoch;
    let skip = 0;
    if (this.#nextSequence !== null) {
      const jump = frame.sequence - this.#nextSequence;
      if (jump > 0) this.#appendGap(jump, frame.sampleTime);
      skip = Math.min(Math.max(0, -jump), frame.samples);
    }
    skip = Math.max(skip, frame.samples - this.retain);
    if (skip >= frame.samples) return;
    this.#append(frame, skip);
    this.#nextSequence = frame.nextSequence;
    this.version += 1;
  }

  #appendGap(samples, sampleTime) {
    this.lostSamples += samples;
    if (!this.length) return;
    this.#makeRoom(1);
    this.#time[this.#end] = this.#time[this.#end - 1] + sampleTime;
    for (const column of this.#columns.values()) column[this.#end] = NaN;
    this.#end += 1;
  }

  #append(frame, skip) {
    const count = frame.samples - skip;
    this.#makeRoom(count);
    for (let i = 0; i < count; i += 1) this.#time[this.#end + i] = frame.startTime + (skip + i) * frame.sampleTime;
    for (const [name, column] of this.#columns) {
      const row = this.#rows.get(name);
      if (row === undefined || row >= frame.channels) column.fill(NaN, this.#end, this.#end + count);
      else column.set(frame.column(row).subarray(skip), this.#end);
    }
    this.#end += count;
    this.#begin = Math.max(this.#begin, this.#end - this.retain);
  }

  #makeRoom(count) {
    if (this.#end + count <= this.#time.length) return;
    const keep = Math.max(0, Math.min(this.length, this.retain, this.#time.length - count));
    for (const array of [this.#time, ...this.#columns.values()]) array.copyWithin(0, this.#end - keep, this.#end);
    this.#begin = 0;
    this.#end = keep;
  }
}

/** @returns {number} index of the first sample at or after `time`, in ascending `times` */
export function firstAtOrAfter(times, time) {
  let low = 0;
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] < time) low = middle + 1;
    else high = middle;
  }
  return low;
}
