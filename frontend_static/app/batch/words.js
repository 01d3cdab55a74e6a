import { briefly } from "../quantity.js";
import { durationWords } from "../recordings/words.js";

/** How facts of batches are written. */

export const STATES = { queued: "waits", running: "running", done: "done", cancelled: "cancelled", failed: "failed" };

/** @returns {string} a whole number with its thousands apart: 1 000 000 */
export function countWords(count) {
  return count === null || count === undefined ? "–" : String(count).replace(/\B(?=(\d{3})+$)/g, " ");
}

/** @returns {string} how long something takes, no more exact than it is known: less than 1 s, 12 s, 2:05 min */
export function spanWords(seconds) {
  if (seconds === null || seconds === undefined) return "–";
  if (seconds < 1) return "less than 1 s";
  return seconds < 60 ? `${Math.round(seconds)} s` : durationWords(seconds);
}

/** @returns {string} "3 000 runs/s" */
export function rateWords(rate) {
  return rate > 0 ? `${countWords(rate >= 10 ? Math.round(rate) : briefly(rate))} runs/s` : "";
}

/** @returns {boolean} whether something still happens to a batch */
export function isActive({ state }) {
  return state === "queued" || state === "running";
}

/** @returns {boolean} whether the parts that are missing can still be computed: it was cancelled, or failed */
export function isResumable({ state }) {
  return state === "cancelled" || state === "failed";
}

/** @returns {boolean} whether no part of it is there yet: perhaps its code is compiled first */
export function isPreparing({ state, progress }) {
  return state === "running" && !progress?.done;
}

/** @returns {string} how its runs ended: "430 done, 8 ended early, 3 refused" */
export function countsWords(counts) {
  const { done = 0, ended = 0, refused = 0 } = counts ?? {};
  const parts = [`${countWords(done)} done`];
  if (ended) parts.push(`${countWords(ended)} ended early`);
  if (refused) parts.push(`${countWords(refused)} refused`);
  return parts.join(", ");
}

/** @returns {string} what the server tells without capital and full stop, as a sentence; "" stays so */
export function sentence(words) {
  if (!words) return "";
  return `${words[0].toUpperCase()}${words.slice(1)}${/[.!?]$/.test(words) ? "" : "."}`;
}

/** @returns {string} "1 run", "441 runs" */
export function runsWords(runs) {
  return `${countWords(runs)} run${runs === 1 ? "" : "s"}`;
}
