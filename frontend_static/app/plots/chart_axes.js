import { niceTicks, tickTexts } from "./nice_ticks.js";

const LEFT_PX = 52;
export const RIGHT_PX = 44;
export const TIME_AXIS_PX = 22;
const TICK_EVERY_PX = 21;
const TIME_TICK_EVERY_PX = 90;
const MOST_TIME_TICKS = 8;
const FONT = '11px system-ui, -apple-system, "Segoe UI", sans-serif';

/**
 * The axes of one chart: the same widths everywhere, so that all charts share one time axis; its words stand only under
 * the last chart.
 *
 * @param {{left: object, right?: object}} sides unit factors of the y scales, as in chart_list.js
 * @returns {object[]} uPlot axes
 */
export function chartAxes({ left, right }, palette, hasTimeAxis) {
  const base = {
    font: FONT,
    stroke: () => palette.colour("axis-text"),
    grid: { stroke: () => palette.colour("grid"), width: 1 },
    ticks: { show: false },
    gap: 6,
  };
  const axes = [timeAxis(base, hasTimeAxis), { ...yAxis(base, left), scale: "left", side: 3, size: LEFT_PX }];
  if (right) {
    axes.push({ ...yAxis(base, right), scale: "right", side: 1, size: RIGHT_PX, grid: { show: false } });
  }
  return axes;
}

function timeAxis(base, hasWords) {
  return {
    ...base,
    size: hasWords ? TIME_AXIS_PX : 0,
    splits: (plot, _, min, max) => {
      const fit = plot.bbox.width / devicePixelRatio / TIME_TICK_EVERY_PX;
      return niceTicks(min, max, Math.max(2, Math.min(MOST_TIME_TICKS, fit)));
    },
    values: (_, ticks) => (hasWords ? tickTexts(ticks).map((text) => `${text} s`) : ticks.map(() => "")),
  };
}

function yAxis(base, { factor = 1 }) {
  return {
    ...base,
    splits: (plot, _, min, max) =>
      niceTicks(min * factor, max * factor, Math.max(2, Math.floor(plot.bbox.height / devicePixelRatio / TICK_EVERY_PX))).map(
        (shown) => shown / factor,
      ),
    values: (_, ticks) => tickTexts(ticks, factor),
  };
}
