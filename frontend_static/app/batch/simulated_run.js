import { TelemetryFrame } from "../session/telemetry_frame.js";

const HELD = { picture: null, marks: null };
const NOTHING = { time: new Float64Array(0), column: () => new Float32Array(0), isExact: true };

/** One run of a batch, simulated anew by the server, as something to plot: see plots/live_source.js. */
export class SimulatedRun extends EventTarget {
  constructor(session) {
    super();
    this.session = session;
    this.isLive = false;
    this.marks = [];
    this.overlays = [];
    this.count = 0;
    this.clear();
    session.addEventListener("hello", () => this.dispatchEvent(new Event("channels")));
  }

  get channels() {
    return this.session.channels;
  }

  get isEmpty() {
    return this.samples.time.length === 0;
  }

  get extent() {
    const { time } = this.samples;
    return time.length > 1 ? [time[0], time.at(-1)] : [0, 1];
  }

  get lastTime() {
    return this.extent[1];
  }

  clear() {
    this.#take(NOTHING);
  }

  /** Plot other samples. @param {ArrayBuffer} buffer telemetry frames, one after the other @throws {Error} if it is none */
  open(buffer) {
    this.#take(samplesOf(framesOf(buffer), [...this.channels.keys()]));
  }

  picture() {
    return this.samples;
  }

  around() {
    return Promise.resolve(this.samples);
  }

  hold() {
    return HELD;
  }

  version() {
    return this.count;
  }

  #take(samples) {
    this.samples = samples;
    this.count += 1;
    this.dispatchEvent(new Event("cleared"));
    this.dispatchEvent(new Event("channels"));
    this.dispatchEvent(new Event("change"));
  }
}

function framesOf(buffer) {
  const frames = [];
  for (let at = 0; at < buffer.byteLength; ) {
    const header = new DataView(buffer, at);
    const end = at + 48 + 4 * header.getUint32(8, true) * header.getUint32(12, true);
    frames.push(new TelemetryFrame(buffer.slice(at, end)));
    at = end;
  }
  return frames;
}

function samplesOf(frames, names) {
  const count = frames.reduce((sum, { samples }) => sum + samples, 0);
  const time = new Float64Array(count);
  const columns = new Map();
  let first = 0;
  for (const frame of frames) {
    for (let i = 0; i < frame.samples; i += 1) time[first + i] = frame.startTime + i * frame.sampleTime;
    first += frame.samples;
  }
  const column = (name) => {
    if (!columns.has(name)) {
      const [values, row] = [new Float32Array(count).fill(NaN), names.indexOf(name)];
      let at = 0;
      for (const frame of frames) {
        if (row >= 0) values.set(frame.column(row), at);
        at += frame.samples;
      }
      columns.set(name, values);
    }
    return columns.get(name);
  };
  return { time, column, isExact: true };
}
