import { sequentialColour } from "../analyse/colour_scale.js";
import { compact } from "../quantity.js";
import { cellScale } from "./cell_scales.js";
import { drawBar, drawMark } from "./heat_bar.js";
import { NumberScale, endsOf } from "./scales.js";

const MOVES = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowDown: [0, -1], ArrowUp: [0, 1] };
const WIDE = 20; // times the least: from here on the colours are logarithmic
const [LEAST_MARK_PX, MOST_MARK_PX] = [9, 16];
const MARKS = [
  { name: "ended", text: "ended" },
  { name: "refused", text: "refused" },
];

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
   *  see columns.js @param {string} gathering @param {boolean} hasSeveral whether a cell may have several runs */
  constructor(points, x, y, figure, gathering, hasSeveral) {
    this.x = { ...x, scale: cellScale(points.map((point) => point.x), x) };
    this.y = { ...y, scale: cellScale(points.map((point) => point.y), y) };
    this.figure = figure;
    this.gathering = GATHERINGS[gathering];
    this.cells = new Map();
    this.places = new Map();
    for (const point of points) this.#put(point);
    for (const cell of this.cells.values()) this.#gather(cell);
    this.hasSeveral = hasSeveral || points.length > this.cells.size;
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
    const [columns, rows] = [this.x.scale.size, this.y.scale.size];
    const [edgeX, edgeY] = [(i) => Math.round(left + (i * width) / columns), (j) => Math.round(top + height - (j * height) / rows)];
    const least = Math.min(width / columns, height / rows);
    for (const { i, j, value, ended, refused } of this.cells.values()) {
      const [x0, y0, x1, y1] = [edgeX(i), edgeY(j + 1), edgeX(i + 1), edgeY(j)];
      ctx.fillStyle = value === null ? palette.colour("track") : sequentialColour(this.colours.at(value));
      ctx.fillRect(x0, y0, x1 - x0, y1 - y0);
      const isMarked = value === null || least >= LEAST_MARK_PX;
      if (isMarked && (ended || refused))
        drawMark(ctx, (x0 + x1) / 2, (y0 + y1) / 2, Math.min(least, MOST_MARK_PX) / 3.2, ended ? "ended" : "refused", value === null ? palette.colour("text") : "#fff");
    }
  }

  legend(ctx, box, palette) {
    const cells = [...this.cells.values()];
    const marks = MARKS.filter(({ name }) => cells.some((cell) => cell[name]));
    drawBar(ctx, box, this.colours, this.title, marks, palette);
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
    if (value !== null) lines.unshift(`${this.hasSeveral ? `${this.gathering.title} ` : ""}${this.figure.label} ${compact(value)} ${this.figure.unit}`.trim());
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
