import { logTicks, tickText } from "../analyse/log_ticks.js";
import { niceTicks } from "../plots/nice_ticks.js";

export const WIDE = 50; // times the least: from here on an axis is logarithmic
const ROOM = 0.03;
const LITTLE = 8; // times the least: up to here an axis has too few decades for their ticks

/** A continuous axis: `at` gives where a value lies, 0 to 1. */
export class NumberScale {
  constructor(low, high, isLogarithmic = false) {
    this.isLogarithmic = isLogarithmic;
    [this.low, this.high] = high > low ? [low, high] : widened(low);
  }

  /**
   * Around all values, with some room. @param {number[]} values @param {boolean|null} isLogarithmic if they allow it; null: if
   * they are wide apart @param {boolean} hasZero whether zero is on it where it is near
   */
  static around(values, isLogarithmic, hasZero) {
    const [low, high] = endsOf(values);
    if (!Number.isFinite(low)) return new NumberScale(0, 1);
    const isLog = low > 0 && (isLogarithmic === null ? high > WIDE * low : isLogarithmic && high > 3 * low);
    if (isLog) return new NumberScale(low / (high / low) ** ROOM, high * (high / low) ** ROOM, true);
    const room = ROOM * (high - low);
    return new NumberScale(hasZero && low >= 0 && low < 0.3 * high ? 0 : low - room, high + room);
  }

  at(value) {
    const { low, high } = this;
    return this.isLogarithmic ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
  }

  /** @returns {number} the value at a place */
  value(at) {
    const { low, high } = this;
    return this.isLogarithmic ? low * (high / low) ** at : low + at * (high - low);
  }

  ticks(count) {
    const { low, high } = this;
    const ticks = this.isLogarithmic && high > LITTLE * low ? logTicks(low, high) : niceTicks(low, high, count);
    return ticks.map((tick) => ({ at: this.at(tick), text: tickText(tick) }));
  }
}

/** @returns {[number, number]} least and greatest; too many values to be arguments of Math.min */
export function endsOf(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return [low, high];
}

function widened(value) {
  const by = Math.abs(value) / 10 || 1;
  return [value - by, value + by];
}
