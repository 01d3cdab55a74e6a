/**
 * The stacked charts: which channels, in which unit and colour. Labels come from the server's channel list unless given.
 *
 * `factor` turns SI into the shown unit. `colour` names a CSS variable (--series-…): one colour a signal, everywhere.
 * A series that `isAlone` has no twin in runs laid over it. `smallest` is the smallest span of a y scale, in SI, so that noise at rest does not fill the chart.
 */
export const CHARTS = [
  {
    id: "position",
    name: "Position",
    left: { unit: "rad", smallest: 0.02 },
    series: [
      { channel: "link_position", colour: "link" },
      { channel: "reference", colour: "reference", dash: [5, 4], isFirstInLegend: true },
    ],
  },
  {
    id: "error",
    name: "Tracking error",
    left: { unit: "mrad", factor: 1e3, smallest: 1e-4 },
    series: [{ channel: "error", label: "tracking error", colour: "link" }],
  },
  {
    id: "torque",
    name: "Motor torque",
    left: { unit: "N·m", smallest: 2 },
    series: [
      {
        channel: "motor_torque_demand",
        label: "demanded",
        colour: "torque",
        isFaint: true,
        onlyWhenUnlike: "motor_torque",
      },
      { channel: "motor_torque", colour: "torque", isFirstInLegend: true },
    ],
    limit: { channel: "motor_torque_limit", of: "motor_torque", label: "limit ±", near: 0.6 },
  },
  {
    id: "disturbance",
    name: "Disturbance and its estimate",
    left: { unit: "N·m", smallest: 1 },
    series: [
      { channel: "link_disturbance", label: "disturbance", colour: "disturbance", width: 2.5 },
      { channel: "link_disturbance_estimate", label: "estimate", colour: "link", width: 1.25 },
      { channel: "motor_disturbance", label: "on motor", colour: "motor-disturbance", width: 2.5, isHidden: true },
      { channel: "motor_disturbance_estimate", label: "its estimate", colour: "torque", width: 1.25, isHidden: true },
    ],
  },
  {
    id: "stiffness",
    name: "Stiffness and deflection",
    left: { unit: "N·m/rad", smallest: 20 },
    right: { unit: "mrad", factor: 1e3, smallest: 2e-3 },
    series: [
      { channel: "deflection", colour: "deflection", side: "right" },
      { channel: "stiffness_reference", label: "asked", colour: "reference", dash: [5, 4] },
      { channel: "stiffness", colour: "stiffness", isFirstInLegend: true },
    ],
  },
];

/** @returns {string[]} every channel that a chart needs */
export function channelsOf(charts) {
  const names = charts.flatMap(({ series, limit }) => [
    ...series.map(({ channel }) => channel),
    ...(limit ? [limit.channel] : []),
  ]);
  return [...new Set(names)];
}
