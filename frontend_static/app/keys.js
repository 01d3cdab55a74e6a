/**
 * Every key of the page, once: the bindings and the `?` dialog read this table. `does` names an action given to
 * `bindKeys`. Only a key with `whileTyping` acts in a text field.
 */
export const KEYS = [
  {
    key: "Escape",
    shown: "Esc",
    does: "stop",
    text: "Stop: zero motor torque at once. Also while typing.",
    whileTyping: true,
  },
  { key: " ", shown: "Space", does: "pauseOrResume", text: "Pause or resume; with a recording open, play or pause its replay" },
  { key: ".", shown: ".", does: "step", text: "Step one sample, while paused; with a recording open, one sample on" },
  { key: "f", shown: "F", does: "freeze", text: "Freeze the picture, or follow again; the recording goes on" },
  { key: "c", shown: "C", does: "cursors", text: "Measuring cursors: click sets A, then B" },
  { key: "p", shown: "P", does: "pin", text: "Pin the window shown: it stays behind the live run" },
  { key: "z", shown: "Ctrl+Z", does: "undo", text: "Undo the last change, whoever made it", ctrl: true },
  { key: "z", shown: "Ctrl+Shift+Z", does: "redo", text: "Redo", ctrl: true, shift: true },
  { key: "s", shown: "Ctrl+S", does: "savePreset", text: "Save the preset", ctrl: true, whileTyping: false },
  { key: "1", shown: "1", does: "viewTune", text: "View: Tune" },
  { key: "2", shown: "2", does: "viewAnalyse", text: "View: Analyse" },
  { key: "3", shown: "3", does: "viewBatch", text: "View: Batch" },
  { key: "4", shown: "4", does: "viewRecordings", text: "View: Recordings" },
  { key: "5", shown: "5", does: "viewPresets", text: "View: Presets" },
  { key: "6", shown: "6", does: "viewHardware", text: "View: Hardware" },
  { key: "?", shown: "?", does: "showKeys", text: "These keys" },
];

/** Keys that the focused control itself understands; listed in the dialog, bound where they act. */
export const ROW_KEYS = [
  { shown: "← → ↑ ↓", text: "On a slider or in a number box: one step; Shift ten steps, Alt a tenth" },
  { shown: "Enter", text: "In a number box: apply" },
  { shown: "Double click", text: "On a name or slider: back to the preset’s value. On a plot: follow again" },
  { shown: "Wheel", text: "Over a y axis: scale it. Over a recording’s plot: zoom; with Shift, move along" },
  { shown: "↑ ↓", text: "In the list of recordings: another one; Enter opens it, Space lays it over the one that you open" },
  { shown: "← → ↑ ↓", text: "Held on the jog pad: link left and right, stiffer and softer; letting go stops" },
  { shown: "← →", text: "On the bar of a replay: back and forth" },
  { shown: "← → ↑ ↓", text: "In a map or a plot of a batch: read it; Enter shows the run" },
];

const NOT_TYPING = new Set(["range", "radio", "checkbox", "button"]);

function isTyping(target) {
  if (target instanceof HTMLInputElement) return !NOT_TYPING.has(target.type);
  return (
    target instanceof HTMLSelectElement || target instanceof HTMLTextAreaElement || target.isContentEditable === true
  );
}

/** A focused button or link takes the space bar for itself. */
function isPressable(target) {
  return (
    target instanceof HTMLButtonElement ||
    target instanceof HTMLAnchorElement ||
    target.tagName === "SUMMARY" ||
    target instanceof HTMLInputElement
  );
}

/** Listen for all keys of the table. @param {Object<string, () => void>} actions one function for each `does` */
export function bindKeys(actions) {
  addEventListener(
    "keydown",
    (event) => {
      const bound = KEYS.find((entry) => matches(entry, event));
      if (!bound || (!bound.whileTyping && (isTyping(event.target) || document.querySelector("dialog[open]")))) return;
      if (bound.key === " " && isPressable(event.target)) return;
      if (!bound.whileTyping) event.preventDefault();
      if (bound.key === "Escape") document.querySelector("dialog[open]")?.close();
      if (!event.repeat) actions[bound.does]();
    },
    { capture: true },
  );
}

function matches(entry, event) {
  const ctrl = event.ctrlKey || event.metaKey;
  if (event.altKey || Boolean(entry.ctrl) !== ctrl) return false;
  if (entry.ctrl && Boolean(entry.shift) !== event.shiftKey) return false;
  return entry.key.toLowerCase() === event.key.toLowerCase();
}
