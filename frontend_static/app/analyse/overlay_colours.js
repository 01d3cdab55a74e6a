import { sequentialColour } from "./colour_scale.js";

const [SOFT, STIFF] = [15, 1200];

/** @returns {string} colour of a stiffness [N m/rad] among others: lighter is stiffer; readable on both backgrounds */
export function overlayColour(stiffness) {
  const share = Math.log(stiffness / SOFT) / Math.log(STIFF / SOFT);
  return sequentialColour(0.25 + 0.5 * Math.min(1, Math.max(0, share)));
}
