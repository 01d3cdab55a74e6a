import { element } from "../element.js";
import { firstAtOrAfter } from "../session/telemetry_store.js";
import { Chart } from "./chart.js";
import { TIME_AXIS_PX } from "./chart_axes.js";
import { CHARTS, channelsOf } from "./chart_list.js";
import { Span } from "./envelope.js";
import { EventMarks } from "./event_marks.js";
import { MeasuringCursors } from "./measuring_cursors.js";
import { Palette } from "./palette.js";
import { TimeWindow } from "./time_window.js";

const LEGEND_PX = 20;
const LEAST_CHART_PX = 60;
const LEGEND_PERIOD_MS = 100;

/** The stacked charts with one time axis and one cursor, drawn once a frame and only when something changed. */
export class PlotStack {
  #drawn = "";
  #isAsked = true;
  #toldAt = 0;
  #isUntold = true;
  #pointer = null;
  #charts = [];

  constructor(root, session, theme) {
    this.session = session;
    this.palette = new Palette(theme);
    this.marks = new EventMarks(session);
    this.timeWindow = new TimeWindow(session.store, this.marks);
    this.cursors = new MeasuringCursors(this.timeWindow, channelsOf(CHARTS));
    this.area = element("div", { class: "chart-stack" });
    root.append(this.area);
    session.addEventListener("hello", () => this.#charts.length || this.#build());
    session.addEventListener("log", () => this.redraw());
    session.store.addEventListener("cleared", () => this.timeWindow.isHeld || this.#restart());
    theme.addEventListener("change", () => this.redraw());
    requestAnimationFrame((now) => this.#frame(now));
  }

  redraw() {
    this.#isAsked = true;
  }

  followAgain() {
    for (const chart of this.#charts) chart.freshScales();
    this.timeWindow.follow();
  }

  /** The pointer moved over a chart. */
  pointAt(chart, plot) {
    if (plot.cursor.event === null || plot.cursor.event === undefined) return;
    const { left } = plot.cursor;
    this.#pointer = left >= 0 ? { plot, left } : null;
    if (this.#pointer) this.marks.point(plot, left, this.timeWindow.marksShown);
    else this.marks.leave();
    this.#toldAt = 0;
    this.redraw();
  }

  #restart() {
    this.cursors.clear();
    for (const chart of this.#charts) chart.freshScales();
  }

  #build() {
    this.#charts = CHARTS.map(
      (layout, i) => new Chart(layout, this, { isTop: i === 0, hasTimeAxis: i === CHARTS.length - 1 }),
    );
    this.area.replaceChildren(...this.#charts.map((chart) => chart.root));
    for (const [i, [width, height]] of this.#sizes().entries()) this.#charts[i].build(width, height);
    new ResizeObserver(() => this.#resize()).observe(this.area);
  }

  #sizes() {
    const { clientWidth, clientHeight } = this.area;
    const each = Math.max(
      LEAST_CHART_PX,
      Math.floor((clientHeight - TIME_AXIS_PX - this.#charts.length * (LEGEND_PX + 1)) / this.#charts.length),
    );
    return this.#charts.map((chart) => [clientWidth, each + (chart.hasTimeAxis ? TIME_AXIS_PX : 0)]);
  }

  /** Hidden with its view, the stack has no size and keeps the one it had. */
  #resize() {
    if (!this.area.clientWidth) return;
    for (const [i, [width, height]] of this.#sizes().entries()) this.#charts[i].resize(width, height);
    this.redraw();
  }

  #frame(now) {
    requestAnimationFrame((next) => this.#frame(next));
    if (!this.#charts.length) return;
    const { timeWindow, cursors } = this;
    const state = `${timeWindow.isHeld ? "held" : this.#moved()}/${timeWindow.version}/${cursors.version}`;
    if (state !== this.#drawn || this.#isAsked) {
      this.#drawn = state;
      this.#isAsked = false;
      this.#isUntold = true;
      this.#draw(now);
    }
    if (this.#isUntold && now - this.#toldAt >= LEGEND_PERIOD_MS) this.#tell(now);
  }

  /** Changes when following the newest sample moves the picture by a pixel. */
  #moved() {
    const { store, snapshot } = this.session;
    if (snapshot?.state !== "running") return store.version;
    this.timeWindow.pixels = this.#charts[0].pixels;
    const perPixel = this.timeWindow.seconds / this.timeWindow.pixels;
    return `${store.epoch}:${store.length > 0}:${Math.ceil(store.lastTime / perPixel)}`;
  }

  #draw(now) {
    const { picture, range } = this.timeWindow;
    const span = new Span(picture.time, range, this.#charts[0].pixels);
    for (const chart of this.#charts) chart.draw(picture, span, range, now);
  }

  #tell(now) {
    this.#toldAt = now;
    this.#isUntold = false;
    const { picture, range } = this.timeWindow;
    const at = this.#toldSample(picture.time, range);
    for (const chart of this.#charts) chart.tell(picture, at);
  }

  /** The sample whose values the legends show: under the pointer, else the newest shown. */
  #toldSample(times, [from, to]) {
    if (!this.#pointer) return Math.min(times.length - 1, firstAtOrAfter(times, to));
    const { plot, left } = this.#pointer;
    const time = from + (left / plot.over.clientWidth) * (to - from);
    return times.length ? Math.min(firstAtOrAfter(times, time), times.length - 1) : -1;
  }
}
