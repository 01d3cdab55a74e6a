/** What the operator does next: Connect, Home, Arm, then move. */

export const STEPS = [
  { id: "connect", text: "Connect" },
  { id: "home", text: "Home" },
  { id: "arm", text: "Arm" },
  { id: "move", text: "Move" },
];

const BEGIN = "Choose a rig on the left, then Connect.";

/**
 * @param {object} snapshot @param {import("../session/operator.js").Operator} operator @param {string} underWay slow command
 * @returns {{at: string, tone: "next"|"busy"|"refused"|"fault", words: string, action: string|null, isPossible: boolean}}
 *   `at`: the step that is next; `action`: what the button beside the words does
 */
export function nextStep(snapshot, operator, underWay) {
  const { rig } = operator;
  const step = (at, tone, words, action = null, isPossible = operator.mayChange) => ({ at, tone, words, action, isPossible });
  if (!operator.session.isConnected) return step("connect", "refused", "No connection to the server; what is shown is old.");
  if (underWay === "connect") return step("connect", "busy", "Connecting: the nodes are looked for and configured. Nothing moves.");
  if (underWay === "disconnect") return step("connect", "busy", "Disconnecting: drives off, then the simulation again.");
  if (!operator.isOnRig && rig.name) return step("connect", "busy", snapshot.sentence);
  if (!operator.isOnRig) return step("connect", "next", `The simulated rig runs. ${BEGIN}`);
  const made = ofState(snapshot, rig, step, operator.session.sentence);
  return operator.mayChange ? made : notInControl(made, operator);
}

function ofState({ state }, rig, step, told) {
  const reasons = (rig.cannot_arm ?? []).map(sentence).join(" ");
  switch (state) {
    case "starting":
      return step("connect", "busy", "Connecting: the control process starts.");
    case "connected":
      return step("home", "next", "The rig answers; its drives are off. Next: Home, so that the stiffness is known.", "home");
    case "homing":
      return step("home", "busy", "Homing: the stiffness motor looks for its two end stops.");
    case "ready":
      if (reasons) return step("arm", "refused", `It cannot be armed yet. ${reasons}`, "arm", false);
      return step("arm", "next", "Homed, drives off. Next: Arm; the rig then holds where it is.", "arm");
    case "armed":
      return step("move", "next", `${sentence(rig.motion || "Holding")} Next: Jog, Go to or Follow.`);
    case "running":
      return step("move", "busy", sentence(rig.motion || "Moving"), "hold");
    case "stopping":
      return step("arm", "busy", "Braking to a stop.");
    case "stopped":
    case "fault":
      return step(rig.homed ? "arm" : "home", "fault", sentence(told), "reset"); // what cannot be reset, the rig says
    default:
      return step("connect", "busy", told);
  }
}

/** What a page that is not in control does next is to get it. */
function notInControl({ at, tone, words }, { control, session, why }) {
  const hasAsked = (control.asking ?? []).includes(session.you);
  const sentences = tone === "fault" ? `${words} ${why}` : hasAsked ? `You have asked for control; ${control.operator} sees it.` : why;
  const action = hasAsked ? null : control.operator ? "askControl" : "takeControl";
  return { at, tone: tone === "fault" ? tone : "refused", words: sentences, action, isPossible: true };
}

/** @returns {string} a clause as a sentence */
export function sentence(words) {
  const text = words.charAt(0).toUpperCase() + words.slice(1);
  return /[.!]$/.test(text) ? text : `${text}.`;
}
