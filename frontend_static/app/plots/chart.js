import uPlot from "/vendor/uPlot.esm.js";
import { element } from "../element.js";
import { RIGHT_PX, chartAxes } from "./chart_axes.js";
import { channelsOf } from "./chart_list.js";
import { Envelope } from "./envelope.js";
import { EventMarks } from "./event_marks.js";
import { Legend } from "./legend.js";
import { LevelLines } from "./level_lines.js";
import { linePath } from "./line_path.js";
import { OverlayLines } from "./overlay_lines.js";
import { YRange } from "./y_range.js";

/** One of the stacked charts: legend strip, uPlot, and y scales that keep still. */
export class Chart {
  #limitIsNear = false;
  #unlike = new Set();

  /** @param {object} layout entry of chart_list.js @param {object} stack PlotStack */
  constructor(layout, stack, { hasTimeAxis, isTop }) {
    this.layout = layout;
    this.stack = stack;
    this.hasTimeAxis = hasTimeAxis;
    this.isTop = isTop;
    this.ranges = {
      left: new YRange(layout.left.smallest),
      right: layout.right ? new YRange(layout.right.smallest) : null,
    };
    this.series = layout.series.map((series) => ({
      side: "left",
      label: stack.source.channels.get(series.channel)?.label ?? series.channel,
      ...series,
    }));
    this.overlays = new OverlayLines(this.series);
    this.levels = new LevelLines(layout.levels);
    this.envelopes = new Map(channelsOf([layout]).map((channel) => [channel, new Envelope()]));
    this.legend = this.#makeLegend();
    this.canvasArea = element("div", { class: "chart-area" });
    this.root = element(
      "section",
      { class: "chart", id: `chart-${layout.id}`, "aria-label": layout.name },
      this.legend.root,
      this.canvasArea,
    );
  }

  /** Width of the plot itself, in device pixels. */
  get pixels() {
    return Math.round(this.plot.bbox.width);
  }

  /** Make the uPlot, once the area has a size. */
  build(width, height) {
    this.plot = new uPlot(
      this.#options(width, height),
      this.#data({ time: new Float64Array(0), column: () => new Float32Array(0) }, 0, 0),
      this.canvasArea,
    );
    this.plot.root.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
    this.plot.over.addEventListener("click", (event) => this.#click(event));
    this.plot.over.addEventListener("pointerdown", (event) => (this.pressedAt = event.clientX));
    this.positionLine = element("div", { class: "chart-position", hidden: true });
    this.plot.over.append(this.positionLine);
  }

  destroy() {
    this.plot?.destroy();
  }

  /** Show where the replay stands; null shows nothing. */
  place(time) {
    const { min, max } = this.plot.scales.x;
    this.positionLine.hidden = time === null || !(time >= min && time <= max);
    if (!this.positionLine.hidden)
      this.positionLine.style.transform = `translateX(${Math.round(this.plot.valToPos(time, "x"))}px)`;
  }

  resize(width, height) {
    this.plot.setSize({ width, height });
  }

  /** Scale and draw the samples of a span of a picture over the time [from, to]. */
  draw(picture, span, [from, to], now) {
    this.overlays.measure(this.stack.source.overlays, [from, to], this.stack.pixels);
    this.#follow(picture, span, now);
    this.plot.batch(() => {
      this.plot.setData(this.#data(picture, span.first, span.last + 1), false);
      this.plot.setScale("x", { min: from, max: to });
    });
  }

  /** Put the values at one sample into the legend. */
  tell(picture, at) {
    const { cursors } = this.stack;
    for (const { item, series } of this.told) {
      item.show(
        at < 0 ? NaN : picture.column(series.channel)[at],
        this.ranges[series.side],
        cursors.difference(series.channel),
        at < 0 ? [] : this.overlays.values(series, picture.time[at]),
      );
      if (series.onlyWhenUnlike) item.root.hidden = !this.#unlike.has(series.channel);
    }
    if (this.limitItem)
      this.limitItem.show(at < 0 ? NaN : picture.column(this.layout.limit.channel)[at], { min: 0, max: 100 }, NaN);
    this.legend.scaleReset.hidden = !this.ranges.left.isManual && !this.ranges.right?.isManual;
  }

  /** Scale at once to what is drawn next, but for what the wheel has scaled. */
  fitScales() {
    for (const range of Object.values(this.ranges)) if (range) range.isFresh = true;
  }

  freshScales() {
    for (const range of Object.values(this.ranges)) range?.reset();
  }

  #makeLegend() {
    const { layout, stack } = this;
    const inOrder = [...this.series].sort((a, b) => Boolean(b.isFirstInLegend) - Boolean(a.isFirstInLegend));
    const entries = inOrder.map((series) => ({
      label: series.label,
      title: stack.source.channels.get(series.channel)?.label ?? series.label,
      colour: `series-${series.colour}`,
      isDashed: Boolean(series.dash),
      isHidden: Boolean(series.isHidden),
      unit: layout[series.side].unit,
      factor: layout[series.side].factor ?? 1,
      toggle: (isHidden) => {
        series.isHidden = isHidden;
        this.plot.setSeries(this.series.indexOf(series) + 1, { show: !isHidden });
        this.ranges[series.side].isFresh = true;
        stack.redraw();
      },
    }));
    if (layout.limit)
      entries.push({
        label: layout.limit.label,
        colour: "limit-line",
        unit: layout.left.unit,
        factor: layout.left.factor ?? 1,
        isStatic: true,
      });
    if (layout.levels)
      entries.push({ label: "limits", colour: "limit-line", isDashed: true, unit: layout.left.unit, words: layout.levels.words, isStatic: true });
    const legend = new Legend(entries);
    this.told = inOrder.map((series, i) => ({ series, item: legend.items[i] }));
    this.limitItem = layout.limit ? legend.items[inOrder.length] : null;
    legend.scaleReset.addEventListener("click", () => {
      this.freshScales();
      stack.redraw();
    });
    return legend;
  }

  #data(picture, from, to) {
    const channels = [
      ...this.series.map(({ channel }) => channel),
      ...(this.layout.limit ? Array(2).fill(this.layout.limit.channel) : []),
    ];
    return [picture.time.subarray(from, to), ...channels.map((name) => picture.column(name).subarray(from, to))];
  }

  #follow(picture, span, now) {
    for (const [channel, envelope] of this.envelopes) envelope.measure(picture.column(channel), span);
    for (const [side, range] of Object.entries(this.ranges)) {
      if (!range) continue;
      const own = this.series.filter((series) => series.side === side && !series.isHidden);
      const shown = [...own.map(({ channel }) => this.envelopes.get(channel)), ...this.overlays.envelopes(side)];
      let low = Math.min(...shown.map(({ min }) => min));
      let high = Math.max(...shown.map(({ max }) => max));
      if (this.layout.limit && side === "left") [low, high] = this.#withLimit(low, high);
      if (side === "left") [low, high] = this.levels.withRoom(low, high);
      range.follow(low, high, now);
    }
    for (const series of this.series) if (series.onlyWhenUnlike) this.#compare(series);
  }

  /** Limits are drawn when the signal comes near; the tightest one is given room. */
  #withLimit(low, high) {
    const { min } = this.envelopes.get(this.layout.limit.channel);
    this.#limitIsNear = Math.max(-low, high) > this.layout.limit.near * min;
    return this.#limitIsNear ? [Math.min(low, -min), Math.max(high, min)] : [low, high];
  }

  #compare({ channel, onlyWhenUnlike, side }) {
    const [one, other] = [this.envelopes.get(channel), this.envelopes.get(onlyWhenUnlike)];
    const visible = 0.01 * (this.ranges[side].max - this.ranges[side].min);
    const isUnlike = Math.abs(one.min - other.min) > visible || Math.abs(one.max - other.max) > visible;
    if (isUnlike) this.#unlike.add(channel);
    else this.#unlike.delete(channel);
  }

  #wheel(event) {
    const area = this.plot.over.getBoundingClientRect();
    const side = event.clientX < area.left ? "left" : event.clientX > area.right ? "right" : null;
    const range = side && this.ranges[side];
    if (!side) this.stack.wheel(event, this.plot.posToVal(event.clientX - area.left, "x"));
    if (!range) return;
    event.preventDefault();
    const about = this.plot.posToVal(event.clientY - area.top, side);
    range.scale(about, event.deltaY > 0 ? 1.15 : 1 / 1.15);
    this.stack.redraw();
  }

  #click(event) {
    if (Math.abs(event.clientX - this.pressedAt) > 3) return;
    this.stack.clickAt(this.plot.posToVal(event.clientX - this.plot.over.getBoundingClientRect().left, "x"));
  }

  #options(width, height) {
    const { palette, timeWindow, cursors, marks } = this.stack;
    const range = (side) => ({ auto: true, range: () => [this.ranges[side].min, this.ranges[side].max] });
    return {
      width,
      height,
      legend: { show: false },
      padding: [6, this.layout.right ? 0 : RIGHT_PX, this.hasTimeAxis ? 0 : 5, 0],
      scales: {
        x: { time: false, range: (_, min, max) => [min, max] },
        left: range("left"),
        ...(this.ranges.right ? { right: range("right") } : {}),
      },
      axes: chartAxes(this.layout, palette, this.hasTimeAxis),
      series: [
        {},
        ...this.series.map((series) => this.#line(series)),
        ...(this.layout.limit ? [this.#limitLine(1), this.#limitLine(-1)] : []),
      ],
      cursor: {
        y: false,
        points: { size: 6, width: 0, fill: (_, index) => this.#pointColour(index) },
        drag: { x: true, y: false, setScale: false },
        sync: { key: this.stack.syncKey, scales: ["x", null] },
        bind: { dblclick: () => () => this.stack.followAgain() },
      },
      hooks: {
        setSelect: [(plot) => this.#selected(plot)],
        setCursor: [(plot) => this.stack.pointAt(this, plot)],
        drawAxes: [(plot) => this.overlays.draw(plot, palette)],
        draw: [
          (plot) => {
            this.levels.draw(plot, palette);
            EventMarks.draw(plot, timeWindow.marksShown, palette);
            cursors.draw(plot, palette, this.isTop);
          },
        ],
      },
    };
  }

  #selected(plot) {
    const { left, width } = plot.select;
    if (width < 4) return;
    const [from, to] = [plot.posToVal(left, "x"), plot.posToVal(left + width, "x")];
    plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    this.stack.timeWindow.zoom(from, to);
  }

  #line({ channel, colour, dash, width, side, isFaint, isHidden, onlyWhenUnlike }) {
    const { palette } = this.stack;
    return {
      scale: side,
      auto: false,
      show: !isHidden,
      width: width ?? (isFaint ? 1 : 1.5),
      stroke: () => (isFaint ? palette.faint(`series-${colour}`, 0.45) : palette.colour(`series-${colour}`)),
      dash,
      paths: linePath({
        envelope: this.envelopes.get(channel),
        isShown: onlyWhenUnlike ? () => this.#unlike.has(channel) : undefined,
      }),
      points: { show: false },
    };
  }

  #pointColour(index) {
    const series = this.series[index - 1];
    return series ? this.stack.palette.colour(`series-${series.colour}`) : "transparent";
  }

  #limitLine(sign) {
    return {
      scale: "left",
      auto: false,
      width: 1,
      stroke: () => this.stack.palette.colour("limit-line"),
      dash: [2, 3],
      paths: linePath({
        envelope: this.envelopes.get(this.layout.limit.channel),
        sign,
        isShown: () => this.#limitIsNear,
      }),
      points: { show: false },
    };
  }
}
