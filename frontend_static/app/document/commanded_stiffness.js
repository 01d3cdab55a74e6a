/** @returns {number|undefined} the stiffness [N m/rad] that a scenario document commands in the end */
export function commandedStiffness(document) {
  const reference = document.value("stiffness_reference");
  return reference?.kind === "move" ? reference.target : reference?.stiffness;
}
