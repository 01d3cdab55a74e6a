import uPlot from "/vendor/uPlot.esm.js";
import { element, setText } from "../element.js";
import { niceTicks, tickTexts } from "../plots/nice_ticks.js";
import { fixed } from "../quantity.js";
import { logTicks, magnitudeText, tickText } from "./log_ticks.js";
import { valueBetween } from "./loop_curves.js";

const LOWEST = 0.1; // rad/s
const LEFT_PX = 50;
const BOTTOM_PX = 24;
const FONT = '11px system-ui, -apple-system, "Segoe UI", sans-serif';
const LEAST_DECADES = 1;

/**
 * One chart over frequency with a legend that tells the values under the cursor, which all charts share.
 *
 * A layout is {name, unit, factor?, isPhase?, clip: [low, high], level, xUnit?, lowest?}: the y axis shows the data inside
 * `clip`, with a line at `level`, if there is one; the x axis begins at `lowest`, in rad/s or `xUnit`.
 */
export class FrequencyChart {
  #curves = [];
  #marks = [];
  #plot = null;

  /** @param {object} layout @param {object} palette @param {(frequency: number|null) => void} pointed */
  constructor(layout, palette, pointed) {
    this.layout = layout;
    this.palette = palette;
    this.pointed = pointed;
    this.legend = element("div", { class: "frequency-legend" });
    this.area = element("div", { class: "frequency-area chart-area" });
    this.root = element(
      "figure",
      { class: "frequency-chart", "aria-label": layout.name },
      element("figcaption", {}, element("h3", {}, layout.name, layout.unit ? element("small", {}, layout.unit) : null), this.legend),
      this.area,
    );
    new ResizeObserver(() => this.#resize()).observe(this.area);
  }

  /** Draw curves, and marks over them.
   *  @param {{label?: string, colour: string, dash?: number[], width?: number, x: number[], y: number[]}[]} curves SI; only those with a label are in the legend
   *  @param {{at: number, from: number, to: number, text: string, colour: string}[]} marks vertical lines, in the chart's unit */
  show(curves, marks = []) {
    const factor = this.layout.factor ?? 1;
    this.#curves = curves.map((curve) => ({ ...curve, y: curve.y.map((value) => value * factor) }));
    this.#marks = marks;
    this.#makeLegend();
    this.#build();
  }

  get #lowest() {
    return this.layout.lowest ?? LOWEST;
  }

  redraw() {
    this.#plot?.redraw(false, true);
  }

  /** Put the values at a frequency into the legend; null empties them. */
  tell(frequency) {
    for (const { curve, value } of this.told ?? []) {
      const at = frequency === null ? NaN : valueBetween(curve.x, curve.y, frequency);
      setText(value, Number.isNaN(at) ? "" : this.layout.isPhase ? `${fixed(at, 0)}°` : magnitudeText(at));
    }
  }

  #makeLegend() {
    this.told = this.#curves
      .filter((curve) => curve.label)
      .map((curve) => ({ curve, value: element("span", { class: "legend-value" }) }));
    const items = this.told.map(({ curve, value }) => {
      const swatch = element("span", { class: curve.dash ? "swatch dashed" : "swatch" });
      swatch.style.setProperty("--colour", `var(--${curve.colour})`);
      return element("span", { class: "frequency-key" }, swatch, curve.label, value);
    });
    this.legend.replaceChildren(...items);
  }

  #build() {
    this.#plot?.destroy();
    this.#plot = null;
    const { clientWidth: width, clientHeight: height } = this.area;
    if (!width || !height) return;
    const clean = this.#curves.map(({ x, y }) => [x, y.map((value) => (Number.isFinite(value) ? value : null))]);
    const data = clean.length ? uPlot.join(clean) : [[this.#lowest, 1e3]];
    this.#plot = new uPlot(this.#options(width, height), data, this.area);
  }

  #resize() {
    const { clientWidth: width, clientHeight: height } = this.area;
    if (!width || !height) return;
    if (this.#plot) this.#plot.setSize({ width, height });
    else this.#build();
  }

  #range() {
    const [least, most] = this.layout.clip;
    const all = this.#curves.flatMap(({ x, y }) => y.filter((value, i) => x[i] >= this.#lowest && Number.isFinite(value)));
    const level = this.layout.level ?? all[0] ?? 1;
    const low = Math.max(least, Math.min(...all, level));
    const high = Math.min(most, Math.max(...all, level));
    if (this.layout.isPhase) return [90 * Math.floor(low / 90), 90 * Math.ceil(high / 90)];
    const [from, to] = [Math.log10(low) - 0.08, Math.log10(high) + 0.12];
    const lacking = Math.max(0, LEAST_DECADES - (to - from)) / 2;
    return [10 ** (from - lacking), 10 ** (to + lacking)];
  }

  #options(width, height) {
    const { palette, layout } = this;
    const highest = this.#curves[0]?.x.at(-1) ?? 1e3;
    const [low, high] = this.#range();
    const axis = { font: FONT, stroke: () => palette.colour("axis-text"), ticks: { show: false }, gap: 5 };
    const grid = { stroke: () => palette.colour("grid"), width: 1 };
    return {
      width,
      height,
      legend: { show: false },
      padding: [6, 12, 0, 0],
      scales: {
        x: { time: false, distr: 3, log: 10, range: () => [this.#lowest, highest] },
        y: layout.isPhase
          ? { auto: false, range: () => [low, high] }
          : { auto: false, distr: 3, log: 10, range: () => [low, high] },
      },
      axes: [
        {
          ...axis,
          grid,
          size: BOTTOM_PX,
          splits: (_, __, min, max) => logTicks(min, max),
          filter: (_, ticks) => ticks,
          values: (_, ticks) => ticks.map((tick, i) => `${tickText(tick)}${i === ticks.length - 1 ? ` ${layout.xUnit ?? "rad/s"}` : ""}`),
        },
        {
          ...axis,
          grid,
          scale: "y",
          size: LEFT_PX,
          filter: (_, ticks) => ticks,
          splits: (_, __, min, max) => (layout.isPhase ? phaseTicks(min, max) : logTicks(min, max)),
          values: (_, ticks) => (layout.isPhase ? tickTexts(ticks).map((text) => `${text}°`) : ticks.map(tickText)),
        },
      ],
      series: [
        {},
        ...this.#curves.map(({ colour, dash, alpha, width: thick }) => ({
          scale: "y",
          width: thick ?? 1.5,
          pxAlign: 0,
          stroke: () => (alpha ? palette.faint(colour, alpha) : palette.colour(colour)),
          dash,
          spanGaps: true,
          points: { show: false },
        })),
      ],
      cursor: {
        y: false,
        points: { show: false },
        drag: { x: false, y: false },
        sync: { key: "frequency", scales: ["x", null] },
      },
      hooks: {
        setCursor: [
          (plot) => {
            const { left, event } = plot.cursor;
            if (event) this.pointed(left >= 0 ? plot.posToVal(left, "x") : null);
          },
        ],
        drawAxes: [(plot) => this.#level(plot)],
        draw: [(plot) => this.#drawMarks(plot)],
      },
    };
  }

  #level({ ctx, bbox, valToPos }) {
    if (this.layout.level === undefined) return;
    const y = Math.round(valToPos(this.layout.level, "y", true)) + 0.5;
    ctx.save();
    ctx.strokeStyle = this.palette.colour("limit-line");
    ctx.lineWidth = devicePixelRatio;
    ctx.setLineDash([4 * devicePixelRatio, 4 * devicePixelRatio]);
    line(ctx, bbox.left, y, bbox.left + bbox.width, y);
    ctx.restore();
  }

  #drawMarks({ ctx, bbox, valToPos }) {
    const ratio = devicePixelRatio;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.font = `${11 * ratio}px system-ui, sans-serif`;
    ctx.textBaseline = "middle";
    ctx.setLineDash([]);
    for (const { at, from, to, text, colour } of this.#marks) {
      const x = valToPos(at, "x", true);
      const [a, b] = [valToPos(from, "y", true), valToPos(to, "y", true)];
      if (![x, a, b].every(Number.isFinite)) continue;
      ctx.strokeStyle = ctx.fillStyle = this.palette.colour(colour);
      ctx.lineWidth = 2 * ratio;
      line(ctx, x, a, x, b);
      ctx.beginPath();
      ctx.arc(x, b, 2.5 * ratio, 0, 2 * Math.PI);
      ctx.fill();
      const isRoomy = x + (12 + 7 * text.length) * ratio < bbox.left + bbox.width;
      ctx.textAlign = isRoomy ? "left" : "right";
      ctx.fillText(text, x + (isRoomy ? 6 : -6) * ratio, (a + b) / 2);
    }
    ctx.restore();
  }
}

function phaseTicks(min, max) {
  const every = max - min > 400 ? 180 : 90;
  const ticks = [];
  for (let tick = every * Math.ceil(min / every); tick <= max; tick += every) ticks.push(tick);
  return ticks.length > 1 ? ticks : niceTicks(min, max, 4);
}

function line(ctx, x0, y0, x1, y1) {
  ctx.beginPath();
  ctx.moveTo(x0, y0);
  ctx.lineTo(x1, y1);
  ctx.stroke();
}
