import { fixed } from "../quantity.js";

/** How facts of recordings are written. */

const STATES = { recording: "recording…", recovered: "recovered", damaged: "damaged" };
const ORIGINS = { simulation: "simulated", import: "imported" };
const HOUR_S = 3600;

/** @returns {string} bytes in the usual unit: 4.2 MB */
export function sizeWords(bytes) {
  if (bytes === null || bytes === undefined) return "–";
  const units = ["B", "kB", "MB", "GB", "TB"];
  const power = bytes < 1000 ? 0 : Math.min(units.length - 1, Math.floor(Math.log10(bytes) / 3));
  const value = bytes / 1000 ** power;
  return `${fixed(value, power === 0 || value >= 100 ? 0 : 1)} ${units[power]}`;
}

/** @returns {string} a length of time: 8.20 s, 2:05 min, 1:02:05 h */
export function durationWords(seconds) {
  if (seconds === null || seconds === undefined) return "–";
  if (seconds < 60) return `${fixed(seconds, 1)} s`;
  const two = (number) => String(Math.floor(number)).padStart(2, "0");
  if (seconds < HOUR_S) return `${Math.floor(seconds / 60)}:${two(seconds % 60)} min`;
  return `${Math.floor(seconds / HOUR_S)}:${two((seconds % HOUR_S) / 60)}:${two(seconds % 60)} h`;
}

/** @returns {string} local date and time; the seconds only of today */
export function startedWords(iso) {
  const when = new Date(iso);
  if (Number.isNaN(when.getTime())) return "–";
  const today = new Date();
  if (when.toDateString() === today.toDateString()) return `today ${when.toLocaleTimeString([], { hour12: false })}`;
  const time = when.toLocaleTimeString([], { hour12: false, hour: "2-digit", minute: "2-digit" });
  const year = when.getFullYear() === today.getFullYear() ? undefined : "numeric";
  return `${when.toLocaleDateString([], { day: "numeric", month: "short", year })} ${time}`;
}

/** @returns {string} what the recording is called, and when it was made if it has no name of its own */
export function nameOf({ name, scenario, started_at }) {
  const title = scenario?.name ?? scenario;
  return name && name !== title ? name : `${title || "recording"}, ${startedWords(started_at)}`;
}

/** @returns {{text: string, tone: string}} the small word beside a recording, "" for one that is as usual */
export function stateWord({ state, origin }) {
  const text = STATES[state] ?? ORIGINS[origin] ?? "";
  return { text, tone: state === "damaged" ? "warning" : state === "recording" ? "active" : "" };
}

/** @returns {string} where it comes from, "" if from the live session or if its name says so */
export function originWord({ name, origin }) {
  const word = ORIGINS[origin] ?? "";
  return name?.includes(word) ? "" : word;
}

/** @returns {string} "3 events", "1 fault"; "–" while it is not known */
export function counted(number, word) {
  if (number === null || number === undefined) return "–";
  return `${number} ${word}${number === 1 ? "" : "s"}`;
}

/** Read tags from a line of text. @returns {string[]} */
export function readTags(text) {
  return [...new Set(text.split(",").map((tag) => tag.trim()).filter(Boolean))];
}
