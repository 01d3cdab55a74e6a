import { compact, fixed } from "../quantity.js";
import { svg } from "../svg.js";
import { Tip } from "../tip.js";

const WIDTH = 224;
const HEIGHT = 142;
const ORIGIN = { x: 146, y: 128 };
const RADIUS = 122;
const KNEE = 2; // rad/s: below it the radius is linear, above logarithmic
const DAMPINGS = [0.3, 0.5, 0.7, 0.9];
const DECADES = [1, 10, 100, 1000, 10_000, 100_000];
const CROSS = 3.2;
const REACH = 12;
const NEAR = Math.log(1.35);

/**
 * Upper half of the s-plane in polar form: directions are true, so that the rays are of equal damping, and distances from
 * the origin are logarithmic, so that slow and fast poles are seen at once. The outer circle is Nyquist's frequency.
 */
export class PolePlot {
  #shown = [];

  constructor() {
    this.grid = svg("g", { class: "pole-grid" });
    this.crosses = svg("g");
    this.root = svg("svg", { class: "pole-plot", viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img" }, this.grid, this.crosses);
    this.tip = new Tip();
    this.root.addEventListener("pointermove", (event) => this.#point(event));
    this.root.addEventListener("pointerleave", () => this.tip.hide());
  }

  /** @param {object} poles document of vssea_core's Poles @param {number} sampleTime s @param {number|null} bandwidth of the observer, rad/s */
  show(poles, sampleTime, bandwidth) {
    this.#drawGrid(Math.PI / sampleTime);
    this.note = poles.note;
    this.#shown = poles.poles.map((pole, i) => ({ pole, role: roleOf(pole, i === 0, bandwidth), ...this.#place(pole) }));
    this.crosses.replaceChildren(...[...this.#shown].reverse().map(cross));
    const { natural_frequency, damping } = poles.dominant;
    this.root.setAttribute(
      "aria-label",
      `${poles.poles.length} poles and pairs of the sampled loop; the slowest at ${compact(natural_frequency)} rad/s, ` +
        `damping ${fixed(damping, 2)}; ${poles.stable ? "all stable" : "unstable"}`,
    );
  }

  #place({ continuous: [real, imaginary], natural_frequency }) {
    const size = this.#radius(natural_frequency);
    const angle = Math.atan2(imaginary, real);
    return { x: ORIGIN.x + size * Math.cos(angle), y: ORIGIN.y - size * Math.sin(angle) };
  }

  #radius(frequency) {
    return (RADIUS * Math.log1p(frequency / KNEE)) / Math.log1p(this.nyquist / KNEE);
  }

  #drawGrid(nyquist) {
    if (nyquist === this.nyquist) return;
    this.nyquist = nyquist;
    const { x, y } = ORIGIN;
    const right = WIDTH - x;
    const decades = DECADES.filter((each) => each >= 10 && each < 0.9 * nyquist);
    this.grid.replaceChildren(
      svg("rect", { class: "pole-unstable", x, y: 0, width: right, height: y }),
      ...decades.map((each) => arc(this.#radius(each))),
      arc(RADIUS, "pole-nyquist"),
      ...DAMPINGS.map((damping) => ray(damping)),
      svg("line", { class: "pole-axis", x1: 0, y1: y, x2: WIDTH, y2: y }),
      svg("line", { class: "pole-axis", x1: x, y1: 0, x2: x, y2: y }),
      ...decades.map((each) => label(x - this.#radius(each), HEIGHT - 3, String(each), "middle")),
      label(x + 2, HEIGHT - 3, "rad/s", "start"),
      label(WIDTH - 3, 11, "unstable", "end"),
    );
  }

  #point(event) {
    const box = this.root.getBoundingClientRect();
    const [x, y] = [((event.clientX - box.left) / box.width) * WIDTH, ((event.clientY - box.top) / box.height) * HEIGHT];
    const near = this.#shown
      .map((each) => ({ ...each, apart: Math.hypot(each.x - x, each.y - y) }))
      .filter((each) => each.apart < REACH)
      .sort((a, b) => a.apart - b.apart);
    this.tip.show(event.clientX, event.clientY, near.length ? this.#words(near) : []);
  }

  #words(near) {
    const lines = near.slice(0, 3).map(({ pole, role }) => `${poleWords(pole)}${role ? ` · ${role}` : ""}`);
    if (near.length > 3) lines.push(`and ${near.length - 3} more`);
    return this.note ? [...lines, `Note: ${this.note}.`] : lines;
  }
}

/** @returns {string} a pole in words: place, damping, frequency */
export function poleWords({ continuous: [real, imaginary], natural_frequency, damping, pair }) {
  const place = pair ? `${compact(real)} ± ${compact(imaginary)} j` : compact(real);
  return `s = ${place} rad/s · damping ${fixed(damping, 2)} · ${compact(natural_frequency / (2 * Math.PI))} Hz`;
}

/** A pole near the bandwidth g belongs to the observer, if not by proof, then by design. */
function roleOf({ natural_frequency, continuous: [real] }, isDominant, bandwidth) {
  if (real >= 0) return "unstable";
  const isNear = bandwidth !== null && Math.abs(Math.log(natural_frequency / bandwidth)) < NEAR;
  if (isDominant) return isNear ? "dominant observer" : "dominant";
  return isNear ? "observer" : "";
}

function cross({ x, y, role }) {
  const size = role.includes("dominant") || role === "unstable" ? CROSS + 0.8 : CROSS;
  const d = `M${x - size},${y - size}L${x + size},${y + size}M${x - size},${y + size}L${x + size},${y - size}`;
  return svg("path", { class: `pole ${role.split(" ").filter(Boolean).map((word) => `pole-${word}`).join(" ")}`, d });
}

function arc(radius, name = null) {
  const { x, y } = ORIGIN;
  const end = Math.min(radius, WIDTH - x);
  const height = Math.sqrt(radius ** 2 - end ** 2);
  return svg("path", { class: name, d: `M${x - radius},${y}A${radius},${radius} 0 0 1 ${x + end},${y - height}` });
}

function ray(damping) {
  const angle = Math.acos(-damping);
  const { x, y } = ORIGIN;
  const [dx, dy] = [RADIUS * Math.cos(angle), RADIUS * Math.sin(angle)];
  return svg(
    "g",
    {},
    svg("line", { x1: x, y1: y, x2: x + dx, y2: y - dy }),
    label(x + 1.03 * dx - 1, y - 1.03 * dy + 3, fixed(damping, 1), "end"),
  );
}

function label(x, y, text, anchor) {
  return svg("text", { x, y, "text-anchor": anchor }, text);
}
