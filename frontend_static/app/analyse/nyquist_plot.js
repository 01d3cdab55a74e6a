import { element } from "../element.js";
import { compact, fixed } from "../quantity.js";
import { svg } from "../svg.js";
import { Tip } from "../tip.js";
import { valueBetween } from "./loop_curves.js";

const CENTRE = { x: -0.6, y: 0 };
const HALF_HEIGHT = 1.7;
const REACH = 0.25;
const LARGE = 30; // beyond it a curve is left out: it comes from far away

/**
 * The loop gain L near −1, for positive frequencies: the point −1, the unit circle, and the circle that the disk margin keeps
 * free.
 */
export class NyquistPlot {
  #curves = [];

  constructor() {
    this.root = element("figure", { class: "frequency-chart", "aria-label": "Nyquist plot of the loop gain near −1" });
    this.drawing = svg("svg", { class: "nyquist", preserveAspectRatio: "xMidYMid slice", role: "img" });
    this.caption = element("span", { class: "frequency-legend" });
    this.root.append(
      element("figcaption", {}, element("h3", {}, "Loop gain near −1"), this.caption),
      element("div", { class: "frequency-area" }, this.drawing),
    );
    this.tip = new Tip();
    this.drawing.addEventListener("pointermove", (event) => this.#point(event));
    this.drawing.addEventListener("pointerleave", () => this.tip.hide());
    new ResizeObserver(() => this.#frame()).observe(this.drawing);
  }

  /** @param {{curve: object, colour: string, dash?: boolean, name: string}[]} curves @param {object|null} margins of the plant's input */
  show(curves, margins) {
    this.#curves = curves;
    this.drawing.setAttribute("aria-label", margins ? `Disk margin ${fixed(margins.disk, 2)}` : "No loop gain to show");
    this.caption.textContent = margins ? `free circle: disk margin α = ${fixed(margins.disk, 2)}` : "";
    this.follower = svg("circle", { class: "nyquist-at", r: 0.045, visibility: "hidden" });
    this.drawing.replaceChildren(
      svg("line", { class: "nyquist-axis", x1: -50, x2: 50, y1: 0, y2: 0 }),
      svg("line", { class: "nyquist-axis", x1: 0, x2: 0, y1: -50, y2: 50 }),
      svg("circle", { class: "nyquist-unit", cx: 0, cy: 0, r: 1 }),
      ...(margins ? [freeCircle(margins.disk_gain)] : []),
      ...curves.map(({ curve, colour, dash }) => trace(curve, colour, dash)),
      ...(margins ? phaseRay(margins, curves[0].curve) : []),
      svg("path", { class: "nyquist-point", d: "M-1.05,-0.05L-0.95,0.05M-1.05,0.05L-0.95,-0.05" }),
      svg("text", { x: -1.06, y: -0.1, "text-anchor": "end" }, "−1"),
      this.follower,
    );
    this.#frame();
  }

  /** Mark the first curve at a frequency; null hides the mark. */
  tell(frequency) {
    const curve = this.#curves[0]?.curve;
    if (!curve || !this.follower) return;
    const at = frequency === null ? NaN : valueBetween(curve.frequencies, curve.real, frequency);
    this.follower.setAttribute("visibility", Number.isFinite(at) ? "visible" : "hidden");
    if (!Number.isFinite(at)) return;
    this.follower.setAttribute("cx", at);
    this.follower.setAttribute("cy", -valueBetween(curve.frequencies, curve.imaginary, frequency));
  }

  #frame() {
    const { clientWidth: width, clientHeight: height } = this.drawing;
    if (!width || !height) return;
    const half = (HALF_HEIGHT * width) / height;
    const box = [CENTRE.x - half, CENTRE.y - HALF_HEIGHT, 2 * half, 2 * HALF_HEIGHT];
    this.drawing.setAttribute("viewBox", box.map((each) => each.toFixed(4)).join(" "));
    this.drawing.style.fontSize = `${(11 * 2 * HALF_HEIGHT) / height}px`;
  }

  #point(event) {
    const box = this.drawing.getBoundingClientRect();
    const scale = (2 * HALF_HEIGHT) / box.height;
    const x = CENTRE.x + (event.clientX - box.left - box.width / 2) * scale;
    const y = -(CENTRE.y + (event.clientY - box.top - box.height / 2) * scale);
    let best = { apart: REACH };
    for (const { curve, name } of this.#curves)
      for (let i = 0; i < curve.real.length; i += 1) {
        const apart = Math.hypot(curve.real[i] - x, curve.imaginary[i] - y);
        if (apart < best.apart) best = { apart, curve, name, i };
      }
    if (!best.curve) return this.tip.hide();
    const { curve, i, name } = best;
    const w = curve.frequencies[i];
    const sign = curve.imaginary[i] < 0 ? "−" : "+";
    this.tip.show(event.clientX, event.clientY, [
      `${compact(w)} rad/s (${compact(w / (2 * Math.PI))} Hz), ${name}`,
      `L = ${fixed(curve.real[i], 2)} ${sign} ${fixed(Math.abs(curve.imaginary[i]), 2)} j`,
      `|1 + L| = ${fixed(Math.hypot(1 + curve.real[i], curve.imaginary[i]), 2)}`,
    ]);
  }
}

function trace({ real, imaginary }, colour, dash) {
  let d = "";
  let isDrawing = false;
  for (let i = 0; i < real.length; i += 1) {
    const isNear = Math.hypot(real[i], imaginary[i]) < LARGE;
    if (isNear) d += `${isDrawing ? "L" : "M"}${real[i].toFixed(4)},${(-imaginary[i]).toFixed(4)}`;
    isDrawing = isNear;
  }
  const path = svg("path", { class: "nyquist-curve", d: d || null, "stroke-dasharray": dash ? "5 4" : null });
  path.style.stroke = `var(--${colour})`;
  return path;
}

/** No L enters the circle through −1/low and −1/high of the gains that the disk margin guarantees. */
function freeCircle([low, high]) {
  const [left, right] = [low > 0 ? -1 / low : -LARGE, high === null ? 0 : -1 / high];
  return svg("circle", { class: "nyquist-free", cx: (left + right) / 2, cy: 0, r: (right - left) / 2 });
}

function phaseRay({ phase, phase_frequency }, curve) {
  if (phase === null || phase_frequency === null) return [];
  const x = valueBetween(curve.frequencies, curve.real, phase_frequency);
  const y = -valueBetween(curve.frequencies, curve.imaginary, phase_frequency);
  const sweep = y > 0 ? 0 : 1;
  return [
    svg("line", { class: "nyquist-phase", x1: 0, y1: 0, x2: x, y2: y }),
    svg("path", { class: "nyquist-phase", d: `M-1,0A1,1 0 0 ${sweep} ${x.toFixed(4)},${y.toFixed(4)}` }),
    svg("text", { class: "nyquist-words", x: x * 1.12, y: y * 1.12 + 0.04, "text-anchor": x < 0 ? "end" : "start" }, `${fixed((phase * 180) / Math.PI, 0)}°`),
  ];
}
