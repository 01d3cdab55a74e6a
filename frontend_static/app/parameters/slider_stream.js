const PERIOD_MS = 1000 / 30;

/**
 * Passes on the values of a moving slider: at most 30 a second, one at a time, always the newest, and the last one
 * for certain. A slow answer thins the values out; it never queues them.
 */
export class SliderStream {
  #waiting = null;
  #isBusy = false;

  /** @param {(value: number) => Promise<any>} send must not reject */
  constructor(send) {
    this.send = send;
  }

  /** Whether a newer value than the one under way has still to be sent. */
  get isWaiting() {
    return this.#waiting !== null;
  }

  move(value) {
    this.#waiting = { value };
    if (!this.#isBusy) this.#drain();
  }

  async #drain() {
    this.#isBusy = true;
    while (this.#waiting) {
      const { value } = this.#waiting;
      this.#waiting = null;
      await Promise.all([this.send(value), new Promise((resolve) => setTimeout(resolve, PERIOD_MS))]);
    }
    this.#isBusy = false;
  }
}
