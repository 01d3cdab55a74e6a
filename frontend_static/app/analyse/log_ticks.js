import { niceTicks } from "../plots/nice_ticks.js";
import { compact } from "../quantity.js";

const FEW_DECADES = 2.3;
const LITTLE = 0.45; // decades

/** @returns {number[]} ticks of a logarithmic axis: decades, and 2 and 5 of each where there is room */
export function logTicks(low, high) {
  const decades = Math.log10(high / low);
  if (decades < LITTLE) return niceTicks(low, high, 4);
  const mantissas = decades < FEW_DECADES ? [1, 2, 5] : [1];
  const every = decades > 8 ? 2 : 1;
  const ticks = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); power += 1)
    for (const mantissa of mantissas) {
      const tick = Number(`${mantissa}e${power}`);
      if (tick >= low * (1 - 1e-9) && tick <= high * (1 + 1e-9) && power % every === 0) ticks.push(tick);
    }
  return ticks;
}

/** @returns {string} a tick in the fewest words: 0.01, 20, 1000, 10⁵ */
export function tickText(value) {
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e5)) {
    const [mantissa, power] = value.toExponential(4).split("e").map(Number);
    return `${mantissa === 1 ? "" : `${signed(mantissa)}·`}10${raised(power)}`;
  }
  return signed(Number(value.toPrecision(6)));
}

function signed(number) {
  return String(number).replace("-", "−");
}

/** @returns {string} a magnitude, with its power of ten where it is very small or large */
export function magnitudeText(value) {
  if (value === null || Number.isNaN(value)) return "–";
  return value !== 0 && (value < 1e-3 || value >= 1e5) ? scientific(value) : compact(value);
}

function scientific(value) {
  const power = Math.floor(Math.log10(value));
  return `${(value / 10 ** power).toFixed(1)}·10${raised(power)}`;
}

function raised(power) {
  return String(power)
    .replace("-", "⁻")
    .replace(/\d/g, (digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[digit]);
}
