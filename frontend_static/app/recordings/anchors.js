import { fixed } from "../quantity.js";

/** Where recordings are laid over each other: an anchor is {kind: "start"} or the n-th event of a kind. */

const WORDS = {
  tuning: "tuning change",
  disturbance: "disturbance event",
  reference: "reference change",
  stiffness: "stiffness change",
  sequence: "step of the sequence",
  trigger: "trigger",
  fault: "fault",
  limit: "limit",
};
const MOST_OF_A_KIND = 12;

/** @returns {{value: string, text: string}[]} what recordings can be aligned at, from the events of one */
export function anchorChoices(facts) {
  const counts = {};
  const choices = eventsOf(facts).flatMap(({ kind, time_s, text }) => {
    counts[kind] = (counts[kind] ?? 0) + 1;
    if (counts[kind] > MOST_OF_A_KIND) return [];
    return { value: `${kind} ${counts[kind]}`, text: `${ordinal(counts[kind])} ${WORDS[kind]}, ${fixed(time_s, 2)} s: ${text}` };
  });
  return [{ value: "start", text: "t = 0" }, ...choices];
}

/** @returns {number} time of an anchor in a recording, NaN if it has none */
export function anchorTime(facts, anchor) {
  if (anchor === "start") return 0;
  const [kind, number] = anchor.split(" ");
  return eventsOf(facts).filter((event) => event.kind === kind)[Number(number) - 1]?.time_s ?? NaN;
}

/** @returns {string} an anchor in words: "2nd tuning change" */
export function anchorWords(anchor) {
  const [kind, number] = anchor.split(" ");
  return anchor === "start" ? "t = 0" : `${ordinal(Number(number))} ${WORDS[kind]}`;
}

function eventsOf({ events }) {
  return events.filter(({ kind, time_s }) => WORDS[kind] && time_s !== null);
}

function ordinal(number) {
  const ending = { 1: "st", 2: "nd", 3: "rd" }[number % 10] ?? "th";
  return `${number}${number % 100 > 10 && number % 100 < 14 ? "th" : ending}`;
}
