import { element } from "../element.js";

/** @returns {Node[]} a symbol such as J_l or θ_l(0), with its index lowered */
export function symbol(text) {
  const [, base, index, rest] = text.match(/^([^_]+)_([\p{L}\p{N},]+)(.*)$/u) ?? [null, text, "", ""];
  return [base, index ? element("sub", {}, index) : "", rest];
}
