import { briefly } from "../quantity.js";

/** @returns {string} what a reference of the scenario does, in words */
export function referenceWords(reference) {
  if (!reference) return "no reference yet";
  const { kind } = reference;
  if (kind === "sine") return `sine ${briefly(reference.amplitude)} rad, ${briefly(reference.frequency_hz)} Hz`;
  if (kind === "move") return `move ${briefly(reference.origin)} to ${briefly(reference.target)} rad in ${briefly(reference.duration_s)} s`;
  if (kind === "step" || kind === "filtered_step")
    return `step ${briefly(reference.origin)} to ${briefly(reference.target)} rad${kind === "step" ? "" : ", filtered"}`;
  if (kind === "chirp")
    return `chirp ${briefly(reference.amplitude)} rad, ${briefly(reference.start_frequency_hz)} to ${briefly(reference.end_frequency_hz)} Hz`;
  if (kind === "multisine") return `${reference.components.length} sines`;
  if (kind === "jog" && !reference.velocity) return "none set: it would hold where it is";
  if (kind === "jog") return `jog at ${briefly(reference.velocity)} rad/s`;
  if (kind === "recorded") return `${reference.times_s.length} recorded samples`;
  return kind;
}
