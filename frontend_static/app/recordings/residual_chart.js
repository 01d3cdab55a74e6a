import { Residual } from "./residual.js";

const SIDES = [
  { channel: "link_position", label: "link", colour: "link", side: "left" },
  { channel: "motor_torque", label: "motor torque", colour: "torque", side: "right" },
];

/** @returns {string[]} channels whose residual is drawn: those that both runs have */
export function residualChannels(own, other) {
  return SIDES.map(({ channel }) => channel).filter((channel) => own.has(channel) && other?.has(channel));
}

/** @returns {object} the chart of what remains, as in plots/chart_list.js */
export function residualChart(channels) {
  const series = SIDES.filter(({ channel }) => channels.includes(channel)).map(({ channel, ...look }) => ({
    ...look,
    channel: Residual.nameOf(channel),
    label: `${look.label}, residual`,
    isAlone: true,
  }));
  return {
    id: "residual",
    name: "Residual: recording less simulation",
    left: { unit: "mrad", factor: 1e3, smallest: 1e-5 },
    right: { unit: "N·m", smallest: 0.02 },
    series,
  };
}
