import { logTicks, tickText } from "../analyse/log_ticks.js";
import { element } from "../element.js";
import { niceTicks } from "../plots/nice_ticks.js";
import { compact } from "../quantity.js";
import { svg } from "../svg.js";

const [WIDTH, HEIGHT, LEFT, RIGHT, TOP, MIDDLE, BOTTOM] = [560, 300, 52, 14, 12, 196, 266];
const CURVE_POINTS = 60;

/** Stiffness over the stiffness motor's position: model, best fit and what was measured; below, the deviations from the model. */
export class CalibrationChart {
  constructor() {
    this.drawing = svg("svg", { class: "calibration", role: "img", viewBox: `0 0 ${WIDTH} ${HEIGHT}` });
    this.legend = element("p", { class: "calibration-legend" });
    this.root = element("figure", { class: "calibration-figure" }, this.drawing, this.legend);
    this.root.hidden = true; // until there is something to draw
  }

  show({ rows, spring_constant: constant, fit }) {
    this.root.hidden = rows.length === 0;
    if (!rows.length) return;
    const at = rows.map((row) => row.stiffness_motor_position);
    const [low, high] = [0.85 * Math.min(...at), 1.15 * Math.max(...at)];
    const stiffnesses = [...rows.map((row) => row.stiffness), constant / (2 * low ** 3), constant / (2 * high ** 3)];
    const [soft, stiff] = [0.8 * Math.min(...stiffnesses), 1.25 * Math.max(...stiffnesses)];
    const most = Math.max(5, ...rows.map((row) => Math.abs(row.deviation_percent))) * 1.15;
    const x = (position) => LEFT + ((WIDTH - LEFT - RIGHT) * Math.log(position / low)) / Math.log(high / low);
    const y = (stiffness) => MIDDLE - 22 - ((MIDDLE - 22 - TOP) * Math.log(stiffness / soft)) / Math.log(stiff / soft);
    const d = (percent) => (MIDDLE + BOTTOM) / 2 - ((BOTTOM - MIDDLE) / 2) * (percent / most);
    const curve = (spring) =>
      Array.from({ length: CURVE_POINTS }, (_, i) => low * (high / low) ** (i / (CURVE_POINTS - 1)))
        .map((position, i) => `${i ? "L" : "M"}${x(position).toFixed(1)} ${y(spring / (2 * position ** 3)).toFixed(1)}`)
        .join("");
    const marks = rows.map((row) => this.#mark(row, x, y, d));
    this.drawing.replaceChildren(
      ...logTicks(low, high).map((tick) => tickMark(x(tick), tickText(tick))),
      ...logTicks(soft, stiff).map((tick) => level(y(tick), tickText(tick))),
      ...niceTicks(-most, most, 2).map((tick) => level(d(tick), tickText(tick))),
      svg("line", { class: "calibration-zero", x1: LEFT, x2: WIDTH - RIGHT, y1: d(0), y2: d(0) }),
      svg("path", { class: "calibration-model", d: curve(constant) }),
      fit ? svg("path", { class: "calibration-fit", d: curve(fit.spring_constant) }) : null,
      ...marks,
      svg("text", { x: (LEFT + WIDTH - RIGHT) / 2, y: HEIGHT - 2, "text-anchor": "middle" }, "stiffness motor position [rad]"),
      svg("text", { x: WIDTH - RIGHT - 4, y: TOP + 8, "text-anchor": "end" }, "stiffness [N·m/rad]"),
      svg("text", { x: WIDTH - RIGHT - 4, y: MIDDLE - 2, "text-anchor": "end" }, "deviation [%]"),
    );
    this.drawing.setAttribute(
      "aria-label",
      rows.map((row) => `${compact(row.stiffness_motor_position)} rad: ${compact(row.stiffness)} N·m/rad, ${compact(row.deviation_percent)} %`).join("; "),
    );
    this.legend.replaceChildren(key("measured", "● measured"), key("model", "— model"), fit ? key("fit", "- - best fit") : "");
  }

  #mark({ stiffness_motor_position: position, stiffness, deviation_percent: percent, note }, x, y, d) {
    const words = `${compact(position)} rad: ${compact(stiffness)} N·m/rad, ${compact(percent)} % from the model${note ? `; ${note}` : ""}`;
    return svg(
      "g",
      {},
      svg("circle", { class: "calibration-point", cx: x(position), cy: y(stiffness), r: 3.5 }),
      svg("line", { class: "calibration-stem", x1: x(position), x2: x(position), y1: d(0), y2: d(percent) }),
      svg("circle", { class: "calibration-point", cx: x(position), cy: d(percent), r: 2.5 }),
      svg("title", {}, words),
    );
  }
}

function key(tone, text) {
  return element("span", { "data-tone": tone }, text);
}

function tickMark(x, text) {
  return svg(
    "g",
    {},
    svg("line", { class: "calibration-grid", x1: x, x2: x, y1: TOP, y2: BOTTOM }),
    svg("text", { x, y: BOTTOM + 14, "text-anchor": "middle" }, text),
  );
}

function level(y, text) {
  return svg(
    "g",
    {},
    svg("line", { class: "calibration-grid", x1: LEFT, x2: WIDTH - RIGHT, y1: y, y2: y }),
    svg("text", { x: LEFT - 6, y: y + 4, "text-anchor": "end" }, text),
  );
}
