import { CHOICE_WORDS } from "../layout.js";

/** @returns {string} the word for a value of a choice field */
export function wordOf(value, special = {}) {
  return special[value] ?? CHOICE_WORDS[value] ?? String(value).replaceAll("_", " ");
}
