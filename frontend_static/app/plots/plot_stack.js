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
const ZOOM_STEP = 1.25;
let stacks = 0;

/**
 * The stacked charts with one time axis and one cursor, drawn once a frame and only when something changed. What is
 * plotted is a source, see live_source.js.
 *
 * Event `pick` (detail: time in s) for a click that sets no cursor.
 */
export class PlotStack extends EventTarget {
  #drawn = "";
  #isAsked = true;
  #toldAt = 0;
  #isUntold = true;
  #pointer = null;
  #charts = [];
  #position = null;
  #isVisible = false;

  constructor(root, source, theme, layouts = CHARTS) {
    super();
    this.source = source;
    this.layouts = layouts;
    this.syncKey = `time ${(stacks += 1)}`;
    this.palette = new Palette(theme);
    this.marks = new EventMarks();
    this.timeWindow = new TimeWindow(source);
    this.cursors = new MeasuringCursors(this.timeWindow, () => channelsOf(this.layouts));
    this.area = element("div", { class: "chart-stack" });
    root.append(this.area);
    source.addEventListener("channels", () => this.#charts.length || this.#build());
    source.addEventListener("change", () => this.redraw());
    source.addEventListener("cleared", () => (source.isLive && this.timeWindow.isHeld) || this.#restart());
    theme.addEventListener("change", () => this.redraw());
    if (!source.isLive) this.timeWindow.addEventListener("change", () => this.#rescale());
    new ResizeObserver(() => this.#resize()).observe(this.area);
    requestAnimationFrame((now) => this.#frame(now));
  }

  /** Width of a chart's plot, in device pixels. */
  get pixels() {
    return this.#charts[0]?.pixels || this.timeWindow.pixels;
  }

  /** Draw other charts from now on. */
  show(layouts) {
    this.layouts = layouts;
    if (this.source.channels.size) this.#build();
  }

  redraw() {
    this.#isAsked = true;
  }

  followAgain() {
    for (const chart of this.#charts) chart.freshScales();
    this.timeWindow.follow();
  }

  /** Where the replay stands, s; null where there is none. */
  set position(time) {
    this.#position = time;
    this.#isUntold = true;
    for (const chart of this.#charts) chart.place(time);
  }

  get position() {
    return this.#position;
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

  clickAt(time) {
    if (this.cursors.isOn) this.cursors.set(time);
    else this.dispatchEvent(new CustomEvent("pick", { detail: time }));
  }

  /** Over the plot of what stands still, the wheel zooms about the pointer; with Shift, or sideways, it moves along. */
  wheel(event, about) {
    if (this.source.isLive || this.source.isEmpty) return;
    event.preventDefault();
    const [from, to] = this.timeWindow.range;
    const sideways = event.deltaX || (event.shiftKey ? event.deltaY : 0);
    if (sideways) return this.timeWindow.pan((Math.sign(sideways) * (to - from)) / 10);
    const ratio = event.deltaY > 0 ? ZOOM_STEP : 1 / ZOOM_STEP;
    this.timeWindow.zoom(about + (from - about) * ratio, about + (to - about) * ratio);
  }

  /** What stands still is scaled to what is shown of it. */
  #rescale() {
    for (const chart of this.#charts) chart.fitScales();
  }

  #restart() {
    this.cursors.clear();
    for (const chart of this.#charts) chart.freshScales();
  }

  #build() {
    for (const chart of this.#charts) chart.destroy();
    this.#charts = this.layouts.map(
      (layout, i) => new Chart(layout, this, { isTop: i === 0, hasTimeAxis: i === this.layouts.length - 1 }),
    );
    this.#pointer = null;
    this.area.replaceChildren(...this.#charts.map((chart) => chart.root));
    for (const [i, [width, height]] of this.#sizes().entries()) this.#charts[i].build(width, height);
    this.redraw();
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
    this.#isVisible = this.area.clientWidth > 0;
    if (!this.#isVisible) return;
    for (const [i, [width, height]] of this.#sizes().entries()) this.#charts[i].resize(width, height);
    this.redraw();
  }

  #frame(now) {
    requestAnimationFrame((next) => this.#frame(next));
    if (!this.#charts.length || !this.#isVisible) return;
    const { timeWindow, cursors } = this;
    const state = `${this.#moved()}/${timeWindow.version}/${cursors.version}`;
    if (state !== this.#drawn || this.#isAsked) {
      this.#drawn = state;
      this.#isAsked = false;
      this.#isUntold = true;
      this.#draw(now);
    }
    if (this.#isUntold && now - this.#toldAt >= LEGEND_PERIOD_MS) this.#tell(now);
  }

  #moved() {
    const { timeWindow, source } = this;
    if (source.isLive && timeWindow.isHeld) return "held";
    timeWindow.pixels = this.pixels;
    return source.version(timeWindow.seconds / timeWindow.pixels);
  }

  #draw(now) {
    const { picture, range } = this.timeWindow;
    const span = new Span(picture, range, this.#charts[0].pixels);
    for (const chart of this.#charts) chart.draw(picture, span, range, now);
    this.position = this.#position;
  }

  #tell(now) {
    this.#toldAt = now;
    this.#isUntold = false;
    const { picture, range } = this.timeWindow;
    const at = this.#toldSample(picture.time, range);
    for (const chart of this.#charts) chart.tell(picture, at);
  }

  /** The sample whose values the legends show: under the pointer, else where the replay stands, else the newest shown. */
  #toldSample(times, [from, to]) {
    const newest = () => Math.min(times.length - 1, firstAtOrAfter(times, this.#position ?? to));
    if (!this.#pointer) return newest();
    const { plot, left } = this.#pointer;
    const time = from + (left / plot.over.clientWidth) * (to - from);
    return times.length ? Math.min(firstAtOrAfter(times, time), times.length - 1) : -1;
  }
}
