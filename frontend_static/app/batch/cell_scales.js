import { logTicks, tickText } from "../analyse/log_ticks.js";
import { niceTicks } from "../plots/nice_ticks.js";
import { NumberScale, WIDE } from "./scales.js";

const MOST_CELLS = 200;
const BINS = 30;
const SAME = 1e-12; // of a value: the server may round its last digit otherwise

/**
 * An axis of cells beside each other: a few numbers, spans of many, or words. It is what the batch says, so that it stays as it
 * is while results come in; what they say, if they have a value that the batch does not know of.
 *
 * @param {any[]} values of the results @param {{options: object[]|null, isLogarithmic: boolean|null, varied: object|null}} described see columns.js
 */
export function cellScale(values, described) {
  const there = [...new Set(values.filter((value) => value !== null))];
  const known = described.varied && knownScale(described);
  if (known && there.every((value) => known.cellOf(value) >= 0)) return known;
  if (there.some((value) => typeof value !== "number")) return new WordCells(there, described.options);
  return numberCells(there, described.isLogarithmic);
}

function knownScale({ varied: { values, low, high, bins }, options, isLogarithmic }) {
  if (!values) return new SpanCells(low, high, isLogarithmic, Math.min(BINS, bins));
  if (values.every((value) => typeof value === "number")) return numberCells([...new Set(values)], isLogarithmic);
  return new WordCells([...new Set(values.map((value) => (typeof value === "string" ? value : JSON.stringify(value))))], options);
}

function numberCells(values, isLogarithmic) {
  values.sort((a, b) => a - b);
  if (values.length <= MOST_CELLS) return new ValueCells(values);
  const [low, high] = [values[0], values.at(-1)];
  return new SpanCells(low, high, isLogarithmic ?? high > WIDE * low);
}

/** A cell for each value; between them, places are interpolated. */
class ValueCells {
  constructor(values) {
    this.values = values;
    this.size = values.length;
    this.places = new Map(values.map((value, place) => [value, place]));
  }

  cellOf(value) {
    if (!this.places.has(value)) this.places.set(value, this.#nearest(value));
    return this.places.get(value);
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

  #nearest(value) {
    const { values, size } = this;
    if (typeof value !== "number") return -1;
    const reach = SAME * Math.max(Math.abs(values[0]), Math.abs(values[size - 1]));
    return values.findIndex((each) => Math.abs(each - value) <= reach);
  }

  #place(value, isGeometric) {
    const { values } = this;
    const above = Math.max(1, values.findIndex((each) => each >= value * (1 - 1e-12)));
    const [a, b] = [values[above - 1], values[above]];
    return above - 1 + (isGeometric ? Math.log(value / a) / Math.log(b / a) : (value - a) / (b - a));
  }
}

/** Equal spans from the least to the greatest of many values; the outermost have what lies beyond, too. */
class SpanCells {
  constructor(low, high, isLogarithmic, bins = BINS) {
    this.scale = new NumberScale(low, high, isLogarithmic && low > 0);
    this.size = bins;
  }

  cellOf(value) {
    if (typeof value !== "number") return -1;
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
    return this.texts[cell];
  }

  textOf(value) {
    return this.texts[this.values.indexOf(value)] ?? String(value);
  }
}
