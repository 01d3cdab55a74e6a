/** The stiffnesses [N m/rad] that may be laid over the analysed loop; analyse.css has a colour for each. */
export const OVERLAYS = [20, 50, 200, 800];

/** @returns {string} name of the CSS variable of a stiffness's colour */
export function overlayColour(stiffness) {
  return `overlay-${stiffness}`;
}
