import { compact } from "../quantity.js";
import { hatched } from "./plot_key.js";
import { NumberScale, endsOf } from "./scales.js";

const BARS = 32;
const WIDE = 50; // times the least: from here on the axis is logarithmic
const MOVES = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 };
const [DONE, ENDED] = ["series-link", "warning"];

/** How often a figure has which value: bars of the runs that are done, hatched on top of them those that ended early. */
export class Histogram {
  hasLegend = false;

  /** @param {{run, state, value}[]} points values as shown @param {object} figure described, see columns.js */
  constructor(points, figure) {
    const there = points.filter(({ value, state }) => typeof value === "number" && state !== "refused");
    const [low, high] = endsOf(there.map(({ value }) => value));
    const scale = there.length ? new NumberScale(low, high, low > 0 && high > WIDE * low) : new NumberScale(0, 1);
    this.figure = figure;
    this.bars = Array.from({ length: BARS }, (_, place) => ({ place, runs: [], ended: 0 }));
    this.ofRun = new Map();
    for (const point of there) {
      const bar = this.bars[Math.min(BARS - 1, Math.max(0, Math.floor(scale.at(point.value) * BARS)))];
      bar.runs.push(point);
      if (point.state === "ended") bar.ended += 1;
      this.ofRun.set(point.run, bar);
    }
    for (const bar of this.bars) bar.runs.sort((a, b) => a.value - b.value);
    const most = endsOf(this.bars.map(({ runs }) => runs.length))[1];
    this.x = { ...figure, scale };
    this.y = { title: "runs", scale: new NumberScale(0, Math.max(1, 1.06 * most)) };
    const hasEnded = this.bars.some(({ ended }) => ended > 0);
    this.keys = hasEnded ? [{ text: "done", colour: DONE, shape: "bar" }, { text: "ended early", colour: ENDED, shape: "hatched" }] : [];
    this.about = `How many of ${there.length} runs have which ${figure.title}.`;
  }

  paint(ctx, { left, top, width, height }, palette) {
    const wide = width / BARS;
    for (const { place, runs, ended } of this.bars) {
      if (!runs.length) continue;
      const x = left + place * wide;
      const tall = (count) => this.y.scale.at(count) * height;
      const done = runs.length - ended;
      ctx.fillStyle = palette.faint(DONE, 0.8);
      ctx.fillRect(x + 0.5, top + height - tall(done), wide - 1, tall(done));
      if (ended) hatched(ctx, x + 0.5, top + height - tall(runs.length), wide - 1, tall(ended), palette.colour(ENDED));
    }
  }

  hit(u) {
    return this.#filled(this.bars[Math.min(BARS - 1, Math.floor(u * BARS))]);
  }

  move(bar, key) {
    const by = MOVES[key];
    let place = bar ? bar.place + by : 0;
    for (; place >= 0 && place < BARS; place += by) if (this.bars[place].runs.length) return this.bars[place];
    return bar;
  }

  where({ place, runs }) {
    return [(place + 0.5) / BARS, this.y.scale.at(runs.length)];
  }

  words({ place, runs, ended }) {
    const { scale, label, unit } = this.x;
    const [from, to] = [place, place + 1].map((edge) => compact(scale.value(edge / BARS)));
    const early = ended ? `, ${ended} ended early` : "";
    return [`${label} ${from} to ${to} ${unit}`.trim(), `${runs.length} run${runs.length === 1 ? "" : "s"}${early}`, `Enter or a click shows run ${this.run({ runs })}, in their middle`];
  }

  /** The run in the middle of a bar. */
  run({ runs }) {
    return runs[Math.floor(runs.length / 2)].run;
  }

  spotOf(run) {
    return this.ofRun.get(run) ?? null;
  }

  #filled(bar) {
    return bar?.runs.length ? bar : null;
  }
}
