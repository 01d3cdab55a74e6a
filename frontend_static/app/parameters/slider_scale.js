const POSITIONS = 1000;
const WIDE = 1e4; // beyond such a ratio no one step suits both ends

/** Places a parameter's values on a slider, linearly or by decades, and rounds what the slider gives to useful steps. */
export class SliderScale {
  /** @param {import("../document/parameter_schema.js").Field} field */
  constructor(field) {
    this.field = field;
    [this.low, this.high] = field.typical;
  }

  static get positions() {
    return POSITIONS;
  }

  /** @returns {number} 0 to 1000; a value beyond the slider's range stays at its end */
  position(value) {
    const { low, high } = this;
    const share = this.field.isLogarithmic
      ? Math.log(Math.max(value, low) / low) / Math.log(high / low)
      : (value - low) / (high - low);
    return Math.round(POSITIONS * Math.min(1, Math.max(0, share)));
  }

  /** @returns {number} value at a slider position, in whole steps and three significant digits */
  value(position) {
    const { low, high } = this;
    const share = position / POSITIONS;
    if (share <= 0) return low;
    if (share >= 1) return high;
    const raw = this.field.isLogarithmic ? low * (high / low) ** share : low + share * (high - low);
    return this.#round(raw);
  }

  /** @returns {number} value moved by some steps and kept inside what is permitted */
  stepped(value, steps) {
    const next = Number((value + steps * this.#stepAt(value)).toPrecision(12));
    return Math.min(this.field.high, Math.max(this.field.low, next));
  }

  /** Over many decades, a step is one in the second digit. */
  #stepAt(value) {
    const isWide = this.field.isLogarithmic && this.high / this.low > WIDE;
    return isWide && value > 0 ? 10 ** (Math.floor(Math.log10(value) + 1e-9) - 1) : this.field.step;
  }

  #round(raw) {
    const three = this.field.isLogarithmic ? Number(raw.toPrecision(3)) : raw;
    const { step } = this.field;
    const whole = Math.round(three / step) * step;
    return Number((whole === 0 && this.field.isLogarithmic ? three : whole).toPrecision(12));
  }
}
