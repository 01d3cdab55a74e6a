/**
 * Which span of time the charts show. Either the picture follows the newest sample, or it is held: a copy of what was
 * recorded up to then, which can be zoomed while the recording goes on.
 *
 * Event `change`.
 */
const KEY = "vssea.window_s";
const SHORTEST_S = 0.01;

export class TimeWindow extends EventTarget {
  static get choices() {
    return [2, 5, 10, 30, 60];
  }

  constructor(store, marks) {
    super();
    this.store = store;
    this.marks = marks;
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
    return this.held?.picture ?? this.store;
  }

  get marksShown() {
    return this.held?.marks ?? this.marks.list;
  }

  /** @returns {[number, number]} first and last time shown, s */
  get range() {
    return this.held?.range ?? this.#following();
  }

  choose(seconds) {
    this.seconds = seconds;
    localStorage.setItem(KEY, seconds);
    if (this.held) this.held.range = [this.held.range[1] - seconds, this.held.range[1]];
    this.#changed();
  }

  freeze() {
    if (this.held || !this.store.length) return;
    this.held = { picture: this.store.copy(), marks: [...this.marks.list], range: this.#following(), isZoomed: false };
    this.#changed();
  }

  follow() {
    this.held = null;
    this.#changed();
  }

  zoom(from, to) {
    if (to - from < SHORTEST_S) return;
    this.freeze();
    if (!this.held) return;
    this.held.range = [from, to];
    this.held.isZoomed = true;
    this.#changed();
  }

  /** Moves by whole pixels, so that a column keeps its samples and noise does not shimmer. */
  #following() {
    const perPixel = this.seconds / this.pixels;
    const end = Math.max(Math.ceil(this.store.lastTime / perPixel) * perPixel, this.seconds);
    return [end - this.seconds, end];
  }

  #changed() {
    this.version += 1;
    this.dispatchEvent(new Event("change"));
  }
}
