const DASHES = [
  [6, 3],
  [2, 2],
  [9, 3, 2, 3],
  [4, 2, 1, 2, 1, 2],
];
const ALPHA = 0.75;
const LIVE = "live";

/** A recording over another one, as plots/overlay_lines.js draws it. */
export class RecordedOverlay {
  /** @param {import("./recorded_run.js").RecordedRun} run @param {number} place 0 for the first */
  constructor(run, place) {
    this.run = run;
    this.key = run.id;
    this.facts = run.facts;
    this.shift = 0;
    this.place(place);
  }

  /** Its number, and how its lines are dashed. */
  place(place) {
    this.label = String(place + 2); // the open recording is the first
    this.dash = DASHES[place % DASHES.length];
    this.alpha = ALPHA;
  }

  get version() {
    return this.run.version;
  }

  picture(range, pixels) {
    return this.run.picture(range, pixels);
  }
}

/** What runs live, over a recording: the last minute of telemetry. */
export class LiveOverlay {
  constructor(session, place) {
    this.session = session;
    this.store = session.store;
    this.key = LIVE;
    this.shift = 0;
    this.place(place);
  }

  get facts() {
    const { events, store } = this.session;
    return { id: LIVE, name: "live", events: events.filter(({ epoch }) => epoch === store.epoch) };
  }

  place(place) {
    RecordedOverlay.prototype.place.call(this, place);
  }

  get version() {
    return this.store.version;
  }

  picture() {
    const { store } = this;
    return { time: store.time, column: (name) => (store.has(name) ? store.column(name) : nothing(store.length)) };
  }
}

function nothing(length) {
  return new Float32Array(length).fill(NaN);
}

export { LIVE };
