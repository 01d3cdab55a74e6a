import { sequentialColour } from "../analyse/colour_scale.js";
import { compact } from "../quantity.js";
import { fitted, line } from "./plot_axes.js";
import { NumberScale, cellScale, endsOf } from "./scales.js";

const MOVES = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowDown: [0, -1], ArrowUp: [0, 1] };
const WIDE = 20; // times the least: from here on the colours are logarithmic
const BAR_PX = 14;
const LEAST_MARK_PX = 9;
const FONT = '11px system-ui, -apple-system, "Segoe UI", sans-serif';

/** What a cell with several runs shows of those that are done. */
export const GATHERINGS = {
  largest: { title: "largest", of: (runs) => runs.reduce((a, b) => (b.value > a.value ? b : a)).value },
  mean: { title: "mean", of: (runs) => runs.reduce((sum, { value }) => sum + value, 0) / runs.length },
  least: { title: "least", of: (runs) => runs.reduce((a, b) => (b.value < a.value ? b : a)).value },
};

/** Two varied fields and a figure: a colour for each cell; × where runs ended early, / where they were refused. */
export class HeatMap {
  hasLegend = true;
  keys = [];

  /** @param {{run, state, x, y, value}[]} points values as shown @param {object} x @param {object} y @param {object} figure described,
   *  see columns.js @param {string} gathering */
  constructor(points, x, y, figure, gathering) {
    this.x = { ...x, scale: cellScale(points.map((point) => point.x), x) };
    this.y = { ...y, scale: cellScale(points.map((point) => point.y), y) };
    this.figure = figure;
    this.gathering = GATHERINGS[gathering];
    this.cells = new Map();
    this.places = new Map();
    for (const point of points) this.#put(point);
    for (const cell of this.cells.values()) this.#gather(cell);
    this.hasSeveral = points.length > this.cells.size;
    const values = [...this.cells.values()].map(({ value }) => value).filter((value) => value !== null);
    const [low, high] = endsOf(values);
    this.colours = values.length ? new NumberScale(low, high, low > 0 && high > WIDE * low) : null;
    const title = this.hasSeveral ? `${this.gathering.title} ${figure.title}` : figure.title;
    this.title = title;
    this.about = `Map of ${title} over ${x.title} and ${y.title}.`;
  }

  #put(point) {
    const [i, j] = [this.x.scale.cellOf(point.x), this.y.scale.cellOf(point.y)];
    if (point.x === null || point.y === null || i < 0 || j < 0) return;
    const key = this.#key(i, j);
    if (!this.cells.has(key)) this.cells.set(key, { i, j, runs: [] });
    this.cells.get(key).runs.push(point);
    this.places.set(point.run, key);
  }

  #gather(cell) {
    const done = cell.runs.filter(({ state, value }) => state === "done" && value !== null);
    cell.ended = cell.runs.filter(({ state }) => state === "ended").length;
    cell.refused = cell.runs.filter(({ state }) => state === "refused").length;
    cell.value = done.length ? this.gathering.of(done) : null;
    const near = (a, b) => (Math.abs(b.value - cell.value) < Math.abs(a.value - cell.value) ? b : a);
    cell.run = (done.length ? done.reduce(near) : cell.runs[0]).run;
  }

  paint(ctx, { left, top, width, height }, palette) {
    const [wide, tall] = [width / this.x.scale.size, height / this.y.scale.size];
    for (const { i, j, value, ended, refused } of this.cells.values()) {
      const [x0, y0] = [left + i * wide, top + height - (j + 1) * tall];
      ctx.fillStyle = value === null ? palette.colour("track") : sequentialColour(this.colours.at(value));
      ctx.fillRect(x0, y0, wide + 0.6, tall + 0.6);
      const isMarked = value === null || Math.min(wide, tall) >= LEAST_MARK_PX;
      if (isMarked && (ended || refused)) cross(ctx, x0 + wide / 2, y0 + tall / 2, Math.min(wide, tall, 16) / 3.2, Boolean(ended), value, palette);
    }
  }

  legend(ctx, { left, top, width, height }, palette) {
    const at = left + width + 26;
    const tall = height - 58;
    ctx.font = FONT;
    ctx.textBaseline = "middle";
    ctx.textAlign = "left";
    const cells = [...this.cells.values()];
    const words = [
      [true, "ended"],
      [false, "refused"],
    ].filter(([isEnded]) => cells.some(({ ended, refused }) => (isEnded ? ended : refused)));
    words.forEach(([isEnded, text], place) => {
      const y = top + tall + 26 + 22 * place;
      ctx.fillStyle = palette.colour("track");
      ctx.fillRect(at, y - 8, BAR_PX, 16);
      cross(ctx, at + BAR_PX / 2, y, 4, isEnded, null, palette);
      ctx.fillStyle = palette.colour("axis-text");
      ctx.fillText(text, at + BAR_PX + 5, y);
    });
    if (!this.colours) return;
    for (let y = 0; y < tall; y += 1) {
      ctx.fillStyle = sequentialColour(1 - y / tall);
      ctx.fillRect(at, top + y, BAR_PX, 1.5);
    }
    ctx.fillStyle = palette.colour("axis-text");
    for (const { at: share, text } of this.colours.ticks(Math.max(2, Math.floor(tall / 50)))) ctx.fillText(text, at + BAR_PX + 5, top + (1 - share) * tall);
    ctx.save();
    ctx.translate(at - 9, top + tall / 2);
    ctx.rotate(-Math.PI / 2);
    ctx.textAlign = "center";
    ctx.fillText(fitted(ctx, this.title, tall), 0, 0);
    ctx.restore();
  }

  hit(u, v) {
    const [i, j] = [Math.floor(u * this.x.scale.size), Math.floor(v * this.y.scale.size)];
    return this.cells.get(this.#key(i, j)) ?? null;
  }

  move(cell, key) {
    const { x, y } = this;
    const [di, dj] = MOVES[key];
    let [i, j] = cell ? [cell.i + di, cell.j + dj] : [Math.floor(x.scale.size / 2), Math.floor(y.scale.size / 2)];
    for (; i >= 0 && j >= 0 && i < x.scale.size && j < y.scale.size; i += di, j += dj)
      if (this.cells.has(this.#key(i, j))) return this.cells.get(this.#key(i, j));
    return cell ?? this.cells.values().next().value ?? null;
  }

  where({ i, j }) {
    return [(i + 0.5) / this.x.scale.size, (j + 0.5) / this.y.scale.size];
  }

  words({ i, j, value, runs, ended, refused, run }) {
    const side = ({ label, unit, scale }, cell) => `${label} ${written(scale.words(cell))} ${unit}`.trim();
    const lines = [side(this.x, i), side(this.y, j)];
    if (value !== null) lines.push(`${this.hasSeveral ? `${this.gathering.title} ` : ""}${this.figure.label} ${compact(value)} ${this.figure.unit}`.trim());
    if (runs.length > 1) lines.push(`${runs.length} runs${ended ? `, ${ended} ended early` : ""}${refused ? `, ${refused} refused` : ""}`);
    else lines.push(`run ${run}${ended ? ", ended early" : ""}${refused ? ", refused" : ""}`);
    return lines;
  }

  run(cell) {
    return cell.run;
  }

  spotOf(run) {
    return this.cells.get(this.places.get(run)) ?? null;
  }

  #key(i, j) {
    return i * this.y.scale.size + j;
  }
}

export function written(value) {
  return typeof value === "number" ? compact(value) : String(value);
}

function cross(ctx, x, y, reach, isEnded, value, palette) {
  ctx.lineWidth = 1.5;
  ctx.strokeStyle = value === null ? palette.colour("text") : "#fff";
  line(ctx, x - reach, y + reach, x + reach, y - reach);
  if (isEnded) line(ctx, x - reach, y - reach, x + reach, y + reach);
}
