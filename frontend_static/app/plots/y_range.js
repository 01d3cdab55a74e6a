import { niceStep } from "./nice_ticks.js";

const PAD = 0.06;
const SHRINK_BELOW = 0.7; // of the present span
const SHRINK_AFTER_MS = 3000;

/**
 * The range of one y scale. It grows at once when the data leave it, shrinks only after the data have needed clearly less
 * for some seconds, and stays where the wheel has put it.
 */
export class YRange {
  #roomySince = null;

  /** @param {number} smallest the smallest span, in the data's unit */
  constructor(smallest) {
    this.smallest = smallest;
    this.reset();
  }

  reset() {
    this.min = -this.smallest / 2;
    this.max = this.smallest / 2;
    this.isManual = false;
    this.#roomySince = null;
    this.isFresh = true;
  }

  /** Make room for data between `low` and `high`. @param {number} now ms, any clock */
  follow(low, high, now) {
    if (this.isManual || !(low <= high)) return;
    const need = this.#needed(low, high);
    if (this.isFresh) return this.#take(need);
    if (low < this.min || high > this.max) {
      this.min = Math.min(this.min, need.min);
      this.max = Math.max(this.max, need.max);
      this.#roomySince = null;
    } else if (need.max - need.min < SHRINK_BELOW * (this.max - this.min)) {
      this.#roomySince ??= now;
      if (now - this.#roomySince > SHRINK_AFTER_MS) this.#take(need);
    } else this.#roomySince = null;
  }

  /** Scale by hand about a value. */
  scale(about, ratio) {
    this.isManual = true;
    this.min = about + (this.min - about) * ratio;
    this.max = about + (this.max - about) * ratio;
  }

  #take({ min, max }) {
    this.min = min;
    this.max = max;
    this.isFresh = false;
    this.#roomySince = null;
  }

  #needed(low, high) {
    const lacking = Math.max(0, this.smallest - (high - low)) / 2;
    const [from, to] = [low - lacking, high + lacking];
    const pad = PAD * (to - from);
    const grain = niceStep((to - from) / 3) / 5;
    return { min: Math.floor((from - pad) / grain) * grain, max: Math.ceil((to + pad) / grain) * grain };
  }
}
