const DEGREES = 180 / Math.PI;

/**
 * What a map can show. `kind` is the task's; `values` picks the layer from its result, in the unit shown; larger is better.
 * `thin` draws a dashed border where a margin becomes thin, see stability/thresholds.js.
 */
export const LAYERS = {
  stability: {
    kind: "stability_map",
    title: "stability",
    legend: "decay of the slowest mode",
    unit: "1/s",
    values: ({ growth }) => each(growth, (value) => -value),
  },
  disk: { kind: "margin_map", title: "disk margin", legend: "disk margin α", unit: "", values: ({ disk }) => disk },
  delay: {
    kind: "margin_map",
    title: "delay margin",
    legend: "delay margin",
    unit: "ms",
    values: ({ delay_s }) => each(delay_s, (value) => 1e3 * value),
  },
  phase: {
    kind: "margin_map",
    title: "phase margin",
    legend: "phase margin",
    unit: "°",
    thin: 20,
    values: ({ phase }) => each(phase, (value) => DEGREES * value),
  },
  gain: {
    kind: "margin_map",
    title: "gain margin, up",
    legend: "gain margin, up",
    unit: "×",
    thin: 1.5,
    values: ({ gain_up }) => gain_up,
  },
  gain_down: {
    kind: "margin_map",
    title: "gain margin, down",
    legend: "gain margin, down",
    unit: "×",
    thin: 1.5,
    values: ({ gain_down }) => each(gain_down, (value) => (value > 0 ? 1 / value : null)),
  },
};

function each(rows, change) {
  return rows.map((row) => row.map((value) => (value === null ? null : change(value))));
}

/** @returns {[number, number]} lowest and highest value to colour, of stable cells, without the last two percent */
export function colourRange(values, stable) {
  const sorted = values
    .flatMap((row, j) => row.filter((value, i) => stable[j][i] && value !== null))
    .sort((a, b) => a - b);
  if (!sorted.length) return [0, 1];
  const low = Math.min(sorted[0], 0);
  const high = sorted[Math.floor(0.98 * (sorted.length - 1))];
  return high > low ? [low, high] : [low, low + 1];
}
