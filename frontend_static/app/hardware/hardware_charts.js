import { briefly } from "../quantity.js";

/**
 * The charts of the view Hardware, in the units chosen, with the rig's limits as lines; layouts as in plots/chart_list.js.
 *
 * @param {import("./display_choices.js").DisplayChoices} choices @param {object} rig of the snapshot @returns {object[]}
 */
export function hardwareCharts(choices, rig) {
  const { limits } = rig;
  const [angle, small, torque] = [choices.linkAngle, choices.smallAngle, choices.motorTorque(rig)];
  return [
    {
      id: "hardware-position",
      name: "Link position",
      left: { ...angle, smallest: 0.02 },
      series: [
        { channel: "link_position", colour: "link" },
        { channel: "reference", colour: "reference", dash: [5, 4], isFirstInLegend: true },
      ],
      levels: limits && levels(limits.link_low, limits.link_high, angle, 0),
    },
    {
      id: "hardware-torque",
      name: torque.unit === "A" ? "Motor current" : "Motor torque",
      left: { ...torque, smallest: 2 },
      series: [{ channel: "motor_torque", label: motorWord(choices, torque), colour: "torque" }],
      levels: limits && levels(-limits.motor_torque, limits.motor_torque, torque, 0.5),
      limit: limits ? undefined : { channel: "motor_torque_limit", of: "motor_torque", label: "limit ±", near: 0.6 },
    },
    {
      id: "hardware-stiffness",
      name: "Stiffness over time",
      left: { unit: "N·m/rad", smallest: 20 },
      series: [
        { channel: "stiffness_reference", label: "asked", colour: "reference", dash: [5, 4] },
        { channel: "stiffness", colour: "stiffness", isFirstInLegend: true },
      ],
      levels: limits && levels(limits.stiffness_low, limits.stiffness_high, { factor: 1 }, 0.8),
    },
    {
      id: "hardware-deflection",
      name: "Deflection",
      left: { ...small, smallest: 2e-3 },
      series: [{ channel: "deflection", colour: "deflection" }],
      levels: limits && levels(-limits.deflection, limits.deflection, small, 0.5),
    },
  ];
}

/** Channels that the view needs beyond those of its charts. */
export const MORE_CHANNELS = ["motor_position", "stiffness_motor_position"];

/** Two lines and their words; drawn once the signal is beyond the share `near` of the way there, 0 = always. */
function levels(low, high, { factor }, near) {
  const [from, to] = [low * factor, high * factor].map((value) => briefly(value));
  return { low, high, near, words: low === -high ? `±${to}` : `${from} to ${to}` };
}

function motorWord(choices, { unit }) {
  if (unit === "A") return "motor current";
  return choices.side === "motor" ? "torque at the motor" : "motor torque";
}
