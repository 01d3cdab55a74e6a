import { CHARTS } from "../plots/chart_list.js";

/** @returns {object[]} the charts that a recording with these channels can fill, as in plots/chart_list.js */
export function chartsFor(channels) {
  return CHARTS.map((chart) => ({
    ...chart,
    series: chart.series.filter((series) => channels.has(series.channel)),
    limit: chart.limit && channels.has(chart.limit.channel) ? chart.limit : undefined,
  }))
    .filter(({ series }) => series.length)
    .map(withoutEmptySide);
}

/** A chart whose left side has nothing shows its right side on the left. */
function withoutEmptySide(chart) {
  if (!chart.right) return chart;
  const sides = new Set(chart.series.map(({ side }) => side ?? "left"));
  if (sides.size === 2) return chart;
  if (sides.has("left")) return { ...chart, right: undefined };
  return { ...chart, left: chart.right, right: undefined, series: chart.series.map((each) => ({ ...each, side: "left" })) };
}
