import { logTicks, tickText } from "../analyse/log_ticks.js";
import { niceTicks } from "../plots/nice_ticks.js";

const MOST_CELLS = 200;
const BINS = 30;
const WIDE = 50; // times the least: from here on an axis is logarithmic
const ROOM = 0.03;

/** A continuous axis: `at` gives where a value lies, 0 to 1. */
export class NumberScale {
  constructor(low, high, isLogarithmic = false) {
    this.isLogarithmic = isLogarithmic;
    [this.low, this.high] = high > low ? [low, high] : widened(low);
  }

  /** Around all values, with some room. @param {number[]} values @param {boolean} isLogarithmic if they allow it */
  static around(values, isLogarithmic) {
    const [low, high] = endsOf(values);
    if (!Number.isFinite(low)) return new NumberScale(0, 1);
    const isLog = low > 0 && (high > WIDE * low || (isLogarithmic && high > 3 * low));
    if (isLog) return new NumberScale(low / (high / low) ** ROOM, high * (high / low) ** ROOM, true);
    const room = ROOM * (high - low);
    return new NumberScale(low >= 0 && low < 0.3 * high ? 0 : low - room, high + room);
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
    const ticks = this.isLogarithmic ? logTicks(low, high) : niceTicks(low, high, count);
    return ticks.map((tick) => ({ at: this.at(tick), text: tickText(tick) }));
  }
}

/** An axis of cells beside each other: a few numbers, spans of many, or words. @param {any[]} values @param {object} described see columns.js */
export function cellScale(values, described) {
  const there = [...new Set(values.filter((value) => value !== null))];
  if (there.some((value) => typeof value !== "number")) return new WordCells(there, described.options);
  there.sort((a, b) => a - b);
  return there.length <= MOST_CELLS ? new ValueCells(there) : new SpanCells(there[0], there.at(-1), described.isLogarithmic);
}

/** A cell for each value; between them, places are interpolated. */
class ValueCells {
  constructor(values) {
    this.values = values;
    this.size = values.length;
    this.places = new Map(values.map((value, place) => [value, place]));
  }

  cellOf(value) {
    return this.places.get(value) ?? -1;
  }

  ticks(count) {
    const { values, size } = this;
    if (size <= Math.max(2, count)) return values.map((value, i) => ({ at: (i + 0.5) / size, text: tickText(value) }));
    const [low, high] = [values[0], values.at(-1)];
    const [middle, isPositive] = [values[Math.floor(size / 2)], low > 0];
    const isGeometric = isPositive && high > 3 * low && Math.abs(middle / Math.sqrt(low * high) - 1) < 0.2;
    const ticks = isGeometric ? logTicks(low, high) : niceTicks(low, high, count);
    return ticks.map((tick) => ({ at: (this.#place(tick, isGeometric) + 0.5) / size, text: tickText(tick) }));
  }

  words(cell) {
    return this.values[cell];
  }

  #place(value, isGeometric) {
    const { values } = this;
    const above = Math.max(1, values.findIndex((each) => each >= value * (1 - 1e-12)));
    const [a, b] = [values[above - 1], values[above]];
    return above - 1 + (isGeometric ? Math.log(value / a) / Math.log(b / a) : (value - a) / (b - a));
  }
}

/** Equal spans from the least to the greatest of many values. */
class SpanCells {
  constructor(low, high, isLogarithmic) {
    this.scale = new NumberScale(low, high, low > 0 && (isLogarithmic || high > WIDE * low));
    this.size = BINS;
  }

  cellOf(value) {
    return Math.min(this.size - 1, Math.max(0, Math.floor(this.scale.at(value) * this.size)));
  }

  ticks(count) {
    return this.scale.ticks(count);
  }

  words(cell) {
    return this.scale.value((cell + 0.5) / this.size);
  }
}

/** A cell for each word. */
export class WordCells {
  constructor(values, options = null) {
    this.values = values;
    this.size = values.length;
    this.texts = values.map((value) => options?.find((option) => String(option.value) === String(value))?.text ?? String(value));
  }

  at(value) {
    return (this.values.indexOf(value) + 0.5) / this.size;
  }

  cellOf(value) {
    return this.values.indexOf(value);
  }

  ticks(count) {
    const every = Math.ceil(this.size / Math.max(1, count));
    return this.texts.map((text, i) => ({ at: (i + 0.5) / this.size, text })).filter((_, i) => i % every === 0);
  }

  words(cell) {
    return this.values[cell];
  }
}

/** @returns {NumberScale|WordCells} the axis of a scatter plot */
export function plainScale(values, described) {
  const there = values.filter((value) => value !== null);
  if (there.some((value) => typeof value !== "number")) return new WordCells([...new Set(there)], described.options);
  return NumberScale.around(there, described.isLogarithmic);
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
