/** From where on a margin is called thin: as vssea_core/analysis/warning.py has it. */
export const THIN_GAIN = 1.5;
export const THIN_PHASE_DEG = 20;
export const THIN_DELAY_SAMPLES = 1.5;
export const THIN_PARAMETER = 1.25;

/** @returns {boolean} whether the nearer of two borders, as factors about 1, lies within `thin`; null is no border */
export function isThinRange(below, above, thin) {
  return (below !== null && below > 1 / thin) || (above !== null && above < thin);
}
