/** Curves over frequency, from what POST /api/analysis answers. */

const ROUNDING = 1e-7; // of |S|; below it L = 1/S - 1 has no phase worth drawing
const DEGREES = 180 / Math.PI;

/** @typedef {{frequencies: number[], magnitude: number[], phase: number[], real?: number[], imaginary?: number[]}} Curve */

/** @returns {Curve|null} a map of the server's list, phase in degrees */
export function mapCurve({ sensitivities }, name) {
  if (!sensitivities) return null;
  const { magnitude, phase } = sensitivities.curves[name];
  return { frequencies: sensitivities.frequencies, magnitude, phase: phase.map((each) => each * DEGREES) };
}

/** @returns {Curve|null} the loop gain L = 1/S - 1 of a break: "S" at the plant's input, "S_limiter" at the limiter */
export function loopGain({ sensitivities, robustness }, name) {
  if (!sensitivities) return null;
  const { frequencies, curves } = sensitivities;
  const { magnitude: size, phase: angle } = curves[name];
  const real = size.map((each, i) => Math.cos(angle[i]) / each - 1);
  const imaginary = size.map((each, i) => -Math.sin(angle[i]) / each);
  const magnitude = real.map((each, i) => Math.hypot(each, imaginary[i]));
  const margins = robustness.margins[name === "S" ? "plant" : "limiter"];
  const crossover = margins?.crossovers.at(-1) ?? frequencies.at(-1);
  const phase = unwrapped(real, imaginary, size, nearest(frequencies, crossover));
  return { frequencies, magnitude, phase, real, imaginary };
}

/** Phase in degrees without jumps; between -360 and 0 at index `anchor`; NaN where S is rounding. */
function unwrapped(real, imaginary, size, anchor) {
  let turn = 0;
  let before = null;
  const phase = real.map((each, i) => {
    if (size[i] < ROUNDING) return NaN;
    const angle = Math.atan2(imaginary[i], each) * DEGREES;
    if (before !== null) turn -= 360 * Math.round((angle + turn - before) / 360);
    before = angle + turn;
    return before;
  });
  const shift = 360 * Math.ceil((phase[anchor] || 0) / 360);
  return phase.map((each) => each - shift);
}

/** @returns {number} index of the frequency nearest to `wanted` on a logarithmic scale */
export function nearest(frequencies, wanted) {
  let low = 0;
  let high = frequencies.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (frequencies[middle] < wanted) low = middle;
    else high = middle;
  }
  return wanted / frequencies[low] < frequencies[high] / wanted ? low : high;
}

/** @returns {number} a value at a frequency, between two points of the curve; NaN outside */
export function valueBetween(frequencies, values, wanted) {
  if (!(wanted >= frequencies[0] && wanted <= frequencies.at(-1))) return NaN;
  const near = nearest(frequencies, wanted);
  const other = wanted > frequencies[near] ? Math.min(near + 1, frequencies.length - 1) : Math.max(near - 1, 0);
  if (other === near) return values[near];
  const share = Math.log(wanted / frequencies[near]) / Math.log(frequencies[other] / frequencies[near]);
  return values[near] + share * (values[other] - values[near]);
}
