/**
 * A sequential scale that colour-blind people read as well: lightness rises evenly from dark blue to light yellow (OKLCH).
 *
 * @param {number} share 0 to 1 @returns {[number, number, number]} red, green, blue, 0 to 255
 */
export function sequential(share) {
  const at = Math.min(1, Math.max(0, share));
  return fromOklch(0.3 + 0.62 * at, 0.11 + 0.05 * Math.sin(Math.PI * at), 275 - 175 * at);
}

/** @returns {string} the same as a CSS colour */
export function sequentialColour(share) {
  return `rgb(${sequential(share).join(" ")})`;
}

function fromOklch(lightness, chroma, hue) {
  const a = chroma * Math.cos((hue * Math.PI) / 180);
  const b = chroma * Math.sin((hue * Math.PI) / 180);
  const l = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (lightness - 0.0894841775 * a - 1.291485548 * b) ** 3;
  return [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ].map((linear) => Math.round(255 * gamma(Math.min(1, Math.max(0, linear)))));
}

function gamma(linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055;
}
