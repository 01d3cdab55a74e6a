import { element, setText } from "../element.js";
import { compact, inputText } from "../quantity.js";
import { svg } from "../svg.js";
import { logTicks, tickText } from "./log_ticks.js";

const LEFT = 92;
const RIGHT = 24;
const TOP = 16;
const BOTTOM = 48;
const WIDTH = 900;
const ROW = 40;

/** Stable intervals of the observer bandwidth g, one line for each stiffness, over log g. */
export class BandwidthSection {
  constructor(scenarioDocument) {
    this.document = scenarioDocument;
    this.caption = element("p", { class: "result-caption" });
    this.drawing = svg("svg", { class: "bandwidths", role: "img", "aria-label": "No bandwidths yet" });
    this.empty = element("p", { class: "result-overlay" }, "No bandwidths yet. Compute them on the left.");
    this.root = element(
      "div",
      { class: "result-section result-scrolls", tabindex: "0", role: "group", "aria-label": "Stable bandwidths" },
      element("div", { class: "result-head" }, this.caption),
      element("div", { class: "bandwidths-area" }, this.drawing),
      this.empty,
    );
    scenarioDocument.addEventListener("change", () => this.result && this.#mark());
  }

  take(result, asked) {
    this.result = result;
    this.empty.hidden = true;
    const { low, high, sets, note, plant } = result;
    const where = plant === "model" ? "its model" : "the actuator";
    const also = asked?.words ? `, for every ${asked.words} at once` : "";
    setText(this.caption, `Observer bandwidths g that are stable with the margins asked for, on ${where}${also}.${note ? ` Note: ${note}.` : ""}`);
    const height = TOP + BOTTOM + ROW * sets.length;
    this.x = (g) => LEFT + ((WIDTH - LEFT - RIGHT) * Math.log(g / low)) / Math.log(high / low);
    this.bottom = height - BOTTOM;
    this.drawing.setAttribute("viewBox", `0 0 ${WIDTH} ${height}`);
    this.drawing.setAttribute(
      "aria-label",
      sets.map(({ stiffness, intervals }) => `${inputText(stiffness)} N·m/rad: ${this.#words(intervals)}`).join("; "),
    );
    this.now = svg("g");
    this.drawing.replaceChildren(
      ...logTicks(low, high).flatMap((tick) => [
        svg("line", { class: "bandwidth-grid", x1: this.x(tick), x2: this.x(tick), y1: TOP, y2: this.bottom }),
        svg("text", { x: this.x(tick), y: this.bottom + 16, "text-anchor": "middle" }, tickText(tick)),
      ]),
      svg("text", { class: "bandwidth-title", x: (LEFT + WIDTH - RIGHT) / 2, y: height - 10, "text-anchor": "middle" }, "observer bandwidth g [rad/s]"),
      ...sets.map((set, i) => this.#line(set, TOP + ROW * (i + 0.5))),
      this.now,
    );
    this.#mark();
  }

  #line({ stiffness, intervals }, y) {
    const bars = intervals.map(([from, to]) => {
      const x = this.x(from);
      return svg(
        "g",
        {},
        svg("rect", { class: "bandwidth-bar", x, y: y - 7, width: Math.max(2, this.x(to) - x), height: 14, rx: 2 }),
        svg("title", {}, `${compact(stiffness)} N·m/rad: stable from ${compact(from)} to ${compact(to)} rad/s`),
      );
    });
    const ends = intervals.length
      ? svg("text", { class: "bandwidth-ends", x: this.x(intervals[0][0]) + 4, y: y - 11 }, this.#words(intervals))
      : svg("text", { class: "bandwidth-ends", x: LEFT + 4, y: y - 6 }, "none is stable with these margins");
    return svg(
      "g",
      {},
      svg("text", { x: LEFT - 10, y: y + 4, "text-anchor": "end" }, `${inputText(stiffness)} N·m/rad`),
      svg("line", { class: "bandwidth-track", x1: LEFT, x2: WIDTH - RIGHT, y1: y, y2: y }),
      ...bars,
      ends,
    );
  }

  /** An interval that ends where the range does may go on. */
  #words(intervals) {
    const { low, high } = this.result;
    const from = (value) => (value <= 1.001 * low ? `≤ ${inputText(low)}` : compact(value));
    const to = (value) => (value >= 0.999 * high ? `≥ ${inputText(high)}` : compact(value));
    return intervals.length ? `${intervals.map(([a, b]) => `${from(a)} to ${to(b)}`).join(", ")} rad/s` : "none";
  }

  /** The bandwidth in force, as a line through all stiffnesses. */
  #mark() {
    const g = this.document.value("tuning.observer.bandwidth");
    const { low, high } = this.result;
    if (!(g >= low && g <= high)) return this.now.replaceChildren();
    const x = this.x(g);
    this.now.replaceChildren(
      svg("line", { class: "bandwidth-now", x1: x, x2: x, y1: TOP - 4, y2: this.bottom }),
      svg("text", { class: "bandwidth-title", x: x + 4, y: TOP - 5 }, `g = ${compact(g)}`),
    );
  }
}

