/**
 * Which span of time the charts show. Of a live source, the picture follows the newest sample or is held: a copy of what
 * was recorded up to then, which can be zoomed while the recording goes on. Of any other, it is all of it or a part.
 *
 * Event `change`.
 */
const KEY = "vssea.window_s";
const SHORTEST_S = 0.01;

export class TimeWindow extends EventTarget {
  static get choices() {
    return [2, 5, 10, 30, 60];
  }

  /** @param {object} source what is plotted, see live_source.js */
  constructor(source) {
    super();
    this.source = source;
    const saved = Number(localStorage.getItem(KEY));
    this.seconds = TimeWindow.choices.includes(saved) ? saved : 10;
    this.held = null;
    this.version = 0;
    this.pixels = 1000;
  }

  get isHeld() {
    return this.held !== null;
  }

  /** @returns {{time: Float64Array, column: (name: string) => Float32Array}} the samples to draw from */
  get picture() {
    return this.held?.picture ?? this.source.picture(this.range, this.pixels);
  }

  get marksShown() {
    return this.held?.marks ?? this.source.marks;
  }

  /** @returns {[number, number]} first and last time shown, s */
  get range() {
    return this.held?.range ?? this.#widest();
  }

  choose(seconds) {
    this.seconds = seconds;
    localStorage.setItem(KEY, seconds);
    if (this.held) this.held.range = [this.held.range[1] - seconds, this.held.range[1]];
    this.#changed();
  }

  freeze() {
    if (this.held || this.source.isEmpty) return;
    this.held = { ...this.source.hold(), range: this.#widest(), isZoomed: false };
    this.#changed();
  }

  follow() {
    this.held = null;
    this.#changed();
  }

  zoom(from, to) {
    const range = this.source.isLive ? [from, to] : within([from, to], this.source.extent);
    if (!(range[1] - range[0] >= SHORTEST_S)) return;
    this.freeze();
    if (!this.held) return;
    this.held.range = range;
    this.held.isZoomed = true;
    this.#changed();
  }

  #widest() {
    return this.source.isLive ? this.#following() : this.source.extent;
  }

  /** Show as much, some seconds later or earlier. */
  pan(seconds) {
    if (!this.held) return;
    const [first, last] = this.source.extent;
    const [from, to] = this.held.range;
    const by = Math.max(first - from, Math.min(last - to, seconds));
    this.held.range = [from + by, to + by];
    this.#changed();
  }

  /** Moves by whole pixels, so that a column keeps its samples and noise does not shimmer. */
  #following() {
    const perPixel = this.seconds / this.pixels;
    const end = Math.max(Math.ceil(this.source.lastTime / perPixel) * perPixel, this.seconds);
    return [end - this.seconds, end];
  }

  #changed() {
    this.version += 1;
    this.dispatchEvent(new Event("change"));
  }
}

/** What two spans have in common. */
function within([from, to], [first, last]) {
  return [Math.max(first, from), Math.min(last, to)];
}
