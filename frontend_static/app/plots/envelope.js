import { firstAtOrAfter } from "../session/telemetry_store.js";

const DENSE = 1.5; // samples a pixel column, from which on columns are drawn instead of samples
const DENSE_PAIRS = 6; // of least and greatest values, whose pairs a column must not part

/** The samples to draw, and, where they are dense, which of them share a pixel column. */
export class Span {
  /** @param {{time: Float64Array, isExact?: boolean}} picture @param {[number, number]} range s @param {number} pixels width of the plot */
  constructor({ time: times, isExact = true }, [from, to], pixels) {
    const dense = isExact ? DENSE : DENSE_PAIRS;
    this.first = Math.max(0, firstAtOrAfter(times, from) - 1);
    this.last = Math.min(times.length - 1, firstAtOrAfter(times, to));
    this.columns = this.last - this.first > dense * pixels ? this.#columns(times, from, to, pixels) : null;
  }

  /** @returns {Int32Array} index of the first sample of each column, and of the first after the last */
  #columns(times, from, to, pixels) {
    const starts = new Int32Array(pixels + 1);
    let index = this.first;
    for (let column = 0; column <= pixels; column += 1) {
      const until = from + ((column - 0.5) / pixels) * (to - from);
      while (index <= this.last && times[index] < until) index += 1;
      starts[column] = index;
    }
    starts[0] = this.first;
    return starts;
  }
}

/** Lowest and highest sample of one channel: over the whole span, and in each pixel column where samples are dense. */
export class Envelope {
  /** Measure the samples of a span; NaN counts for nothing, but breaks the line in its column. */
  measure(values, { first, last, columns }) {
    this.values = values;
    this.columns = columns;
    this.min = Infinity;
    this.max = -Infinity;
    if (!columns) return this.#scan(first, last);
    const count = columns.length - 1;
    if (this.low?.length !== count)
      [this.low, this.high, this.isBroken] = [new Float32Array(count), new Float32Array(count), new Uint8Array(count)];
    for (let column = 0; column < count; column += 1) this.#scanColumn(column, columns[column], columns[column + 1]);
    return this;
  }

  #scanColumn(column, start, end) {
    const { values } = this;
    let low = Infinity;
    let high = -Infinity;
    let valid = 0;
    for (let i = start; i < end; i += 1) {
      const value = values[i];
      if (value < low) low = value;
      if (value > high) high = value;
      if (value === value) valid += 1;
    }
    this.low[column] = low;
    this.high[column] = high;
    this.isBroken[column] = valid < end - start ? 1 : 0;
    if (low < this.min) this.min = low;
    if (high > this.max) this.max = high;
  }

  #scan(first, last) {
    for (let i = first; i <= last; i += 1) {
      const value = this.values[i];
      if (value < this.min) this.min = value;
      if (value > this.max) this.max = value;
    }
    return this;
  }
}
