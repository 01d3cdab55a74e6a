import { markOf } from "../plots/event_marks.js";
import { Samples } from "./samples.js";

const HELD = { picture: null, marks: null };

/**
 * One recording as something to plot, with other runs over it. The interface is that of plots/live_source.js; nothing is
 * held, as a recording stands still.
 */
export class RecordingSource extends EventTarget {
  constructor() {
    super();
    this.isLive = false;
    this.run = null;
    this.overlays = [];
    this.derived = null; // fills in channels that are computed: {fill(picture, range, pixels), version}
    this.count = 0;
  }

  /** Plot a run, or none. @param {import("./recorded_run.js").RecordedRun|null} run */
  open(run) {
    this.run = run;
    this.overlays = [];
    this.derived = null;
    this.count += 1;
    this.readMarks();
    this.dispatchEvent(new Event("cleared"));
    if (run) this.dispatchEvent(new Event("channels"));
  }

  readMarks() {
    this.marks = (this.run?.facts.events ?? []).map((event) => markOf(event)).filter((mark) => mark !== null);
    this.dispatchEvent(new Event("change"));
  }

  get channels() {
    return this.run?.channels ?? new Map();
  }

  get extent() {
    return this.run?.extent ?? [0, 1];
  }

  get lastTime() {
    return this.extent[1];
  }

  get isEmpty() {
    return this.run === null;
  }

  picture(range, pixels) {
    if (!this.run) return Samples.none;
    const picture = this.run.picture(range, pixels);
    this.derived?.fill(picture, range, pixels);
    return picture;
  }

  around(time) {
    return this.run.around(time);
  }

  hold() {
    return HELD;
  }

  version() {
    const others = this.overlays.map((overlay) => `${overlay.key} ${overlay.version} ${overlay.shift}`);
    return `${this.count} ${this.run?.version} ${this.derived?.version} ${others.join()}`;
  }
}
