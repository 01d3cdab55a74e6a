/** Tick positions that people read easily: 1, 2 or 5 times a power of ten apart. */

/** @returns {number} the step nearest above `rough` */
export function niceStep(rough) {
  const power = 10 ** Math.floor(Math.log10(rough));
  const mantissa = rough / power;
  return (mantissa <= 1 ? 1 : mantissa <= 2 ? 2 : mantissa <= 5 ? 5 : 10) * power;
}

/** @returns {number[]} multiples of a nice step inside [low, high]: about `count`, and three where that is possible */
export function niceTicks(low, high, count) {
  const coarse = multiples(low, high, niceStep((high - low) / Math.max(1, count)));
  return coarse.length >= 3 ? coarse : multiples(low, high, niceStep((high - low) / (2 * Math.max(1, count))));
}

function multiples(low, high, step) {
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i += 1)
    ticks.push(Number((i * step).toPrecision(12)));
  return ticks;
}

/** @returns {string[]} the ticks in words, all with the same decimals */
export function tickTexts(ticks, factor = 1) {
  const step = ticks.length > 1 ? Math.abs(ticks[1] - ticks[0]) * factor : Math.abs(ticks[0] ?? 1) * factor || 1;
  const decimals = Math.min(6, Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));
  return ticks.map((tick) => (tick === 0 ? "0" : (tick * factor).toFixed(decimals)).replace("-", "−"));
}
