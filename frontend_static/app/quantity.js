/** How numbers and units are written on the page. */

const MINUS = "−";

/** @returns {string} a value with a fixed number of decimals and a true minus; "–" if there is none */
export function fixed(value, decimals) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  const text = value.toFixed(decimals);
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", MINUS);
}

/** @returns {number} decimals that show at most three significant digits of numbers up to `magnitude` */
export function decimalsFor(magnitude) {
  if (!(magnitude > 0)) return 2;
  return Math.min(4, Math.max(0, 2 - Math.floor(Math.log10(magnitude) + 1e-9)));
}

/** @returns {string} at most three significant digits */
export function significant(value) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  const size = Math.abs(value);
  if (size >= 1e5 || (size > 0 && size < 1e-4)) return exponential(value, 3).replace("-", MINUS);
  return fixed(value, decimalsFor(size));
}

/** @returns {string} at most three significant digits, none of them beyond the third decimal of numbers below 1 */
export function compact(value) {
  const size = Math.abs(value ?? NaN);
  if (size < 1 && size >= 5e-4) return fixed(value, 3);
  return significant(size > 0 ? Number(value.toPrecision(3)) : value);
}

/** @returns {string} the shortest text that a number box can show and read back */
export function inputText(value) {
  if (typeof value !== "number") return "";
  const size = Math.abs(value);
  return size >= 1e6 || (size > 0 && size < 1e-4) ? exponential(value, 6) : String(Number(value.toPrecision(7)));
}

/** @returns {string} a value in a sentence: at most three significant digits, no needless zeros */
export function briefly(value) {
  return typeof value === "number" ? inputText(Number(value.toPrecision(3))).replace("-", MINUS) : "–";
}

/** @returns {number} what was typed, NaN if it is not a number; a decimal comma and a true minus are understood */
export function readNumber(text) {
  const plain = text
    .trim()
    .replace(MINUS, "-")
    .replace(/^([^.,]*),([^.,]*)$/, "$1.$2");
  return plain === "" ? NaN : Number(plain);
}

/** @returns {{factor: number, unit: string}} the unit in which a small quantity is shown */
export function displayUnit(unit) {
  return unit === "rad" ? { factor: 1e3, unit: "mrad" } : { factor: 1, unit };
}

function exponential(value, digits) {
  const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
  return `${Number(mantissa)}e${Number(exponent)}`;
}
