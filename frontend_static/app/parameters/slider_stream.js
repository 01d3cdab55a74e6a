const PERIOD_MS = 1000 / 30;

/** Passes on the values of a moving slider at 30 Hz; the last one always. */
export class SliderStream {
  #timer = null;
  #waiting = null;
  #sentAt = -Infinity;

  /** @param {(value: number) => void} send */
  constructor(send) {
    this.send = send;
  }

  move(value) {
    this.#waiting = { value };
    if (this.#timer === null) this.#timer = setTimeout(() => this.flush(), Math.max(0, this.#sentAt + PERIOD_MS - performance.now()));
  }

  flush() {
    clearTimeout(this.#timer);
    this.#timer = null;
    if (!this.#waiting) return;
    const { value } = this.#waiting;
    this.#waiting = null;
    this.#sentAt = performance.now();
    this.send(value);
  }
}
