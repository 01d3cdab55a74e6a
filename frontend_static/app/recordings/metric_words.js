import { significant } from "../quantity.js";

/** What each metric of a recording's summary is called, and its unit; others are shown by their name. */
export const METRICS = {
  peak_error: { label: "peak error", unit: "mrad", factor: 1e3 },
  rms_error: { label: "RMS error", unit: "mrad", factor: 1e3 },
  peak_torque: { label: "peak torque", unit: "N·m", factor: 1 },
  rms_torque: { label: "RMS torque", unit: "N·m", factor: 1 },
  torque_chatter: { label: "torque chatter", unit: "N·m", factor: 1 },
  saturated: { label: "saturated", unit: "%", factor: 1 },
  saturated_time: { label: "time saturated", unit: "s", factor: 1 },
  observer_error: { label: "observer error", unit: "N·m", factor: 1 },
  motor_observer_error: { label: "motor observer error", unit: "N·m", factor: 1 },
};

/** @returns {{figure: string, unit: string}} one metric as it is shown, "–" if it is not known */
export function metricFigure(metrics, name) {
  const { unit, factor } = METRICS[name];
  const value = metrics?.[name];
  return { figure: significant(typeof value === "number" ? value * factor : null), unit };
}

/** @returns {{label: string, words: string}[]} all metrics, those that are always there first */
export function metricWords(metrics) {
  const known = Object.keys(METRICS).filter((name) => name in (metrics ?? {}));
  const others = Object.keys(metrics ?? {}).filter((name) => !(name in METRICS));
  return [
    ...known.map((name) => {
      const { figure, unit } = metricFigure(metrics, name);
      return { label: METRICS[name].label, words: figure === "–" ? figure : `${figure} ${unit}` };
    }),
    ...others.map((name) => ({ label: name.replaceAll("_", " "), words: significant(metrics[name]) })),
  ];
}
