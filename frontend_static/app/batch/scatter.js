import { written } from "./heat_map.js";
import { crossed } from "./plot_key.js";
import { cellScale } from "./cell_scales.js";
import { NumberScale } from "./scales.js";

const NEAR_PX = 12;
const MANY = 2000;
const GROUPS = ["series-link", "series-torque", "series-stiffness", "series-deflection", "overlay-50", "overlay-800"];
const ENDED = "warning";
const MOVES = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 };

/** Each run a point: a dot if it is done, × if it ended early; in the colour of its group, if runs are told apart by a word. */
export class Scatter {
  hasLegend = false;

  /** @param {{run, state, x, y, group?}[]} points values as shown @param {object} x @param {object} y described, see columns.js
   *  @param {WordCells|null} groups the words of `group` */
  constructor(points, x, y, groups = null) {
    this.groups = groups;
    const there = points.filter((point) => point.x !== null && point.y !== null && point.state !== "refused");
    this.x = { ...x, scale: axisScale(there.map((point) => point.x), x) };
    this.y = { ...y, scale: axisScale(there.map((point) => point.y), y) };
    const placed = ([u, v]) => Number.isFinite(u) && Number.isFinite(v);
    this.points = there.map((point) => ({ ...point, at: [this.x.scale.at(point.x), this.y.scale.at(point.y)] })).filter(({ at }) => placed(at));
    this.points.sort((a, b) => a.at[0] - b.at[0] || a.at[1] - b.at[1]);
    this.ofRun = new Map(this.points.map((point) => [point.run, point]));
    this.keys = (groups?.texts ?? []).map((text, place) => ({ text, colour: GROUPS[place % GROUPS.length], shape: "dot" }));
    if (this.points.some(({ state }) => state !== "done")) this.keys.push({ text: "ended early", colour: groups ? "text" : ENDED, shape: "cross" });
    this.about = `${y.title} of ${this.points.length} runs over ${x.title}.`;
  }

  paint(ctx, { left, top, width, height }, palette) {
    const isMany = this.points.length > MANY;
    const radius = isMany ? 1.5 : 2.75;
    const colours = (this.groups?.values ?? [null]).map((_, place) => GROUPS[place % GROUPS.length]);
    const [fills, strokes] = [colours.map((name) => palette.faint(name, isMany ? 0.5 : 0.8)), colours.map((name) => palette.colour(name))];
    const placeOf = new Map((this.groups?.values ?? []).map((value, place) => [value, place]));
    const of = ({ group }) => placeOf.get(group) ?? 0;
    const pixel = ([u, v]) => [left + u * width, top + (1 - v) * height];
    for (const point of this.points) {
      if (point.state !== "done") continue;
      const [x, y] = pixel(point.at);
      ctx.fillStyle = fills[of(point)];
      ctx.beginPath();
      ctx.arc(x, y, radius, 0, 2 * Math.PI);
      ctx.fill();
    }
    ctx.lineWidth = 1.5;
    for (const point of this.points) {
      if (point.state === "done") continue;
      const [x, y] = pixel(point.at);
      ctx.strokeStyle = this.groups ? strokes[of(point)] : palette.colour(ENDED);
      crossed(ctx, x, y, 3.5);
    }
  }

  hit(u, v, { width, height }) {
    let [best, least] = [null, NEAR_PX ** 2];
    for (const point of this.points) {
      const apart = ((point.at[0] - u) * width) ** 2 + ((point.at[1] - v) * height) ** 2;
      if (apart < least) [best, least] = [point, apart];
    }
    return best;
  }

  move(point, key) {
    if (!this.points.length) return null;
    if (!point) return this.points[Math.floor(this.points.length / 2)];
    const place = this.points.indexOf(point) + MOVES[key];
    return this.points[Math.min(this.points.length - 1, Math.max(0, place))];
  }

  where({ at }) {
    return at;
  }

  words({ run, state, x, y, group }) {
    const side = ({ label, unit, scale }, value) => `${label} ${written(scale.textOf?.(value) ?? value)} ${unit}`.trim();
    const own = this.groups ? [this.groups.textOf(group)] : [];
    return [...own, side(this.y, y), side(this.x, x), `run ${run}${state === "ended" ? ", ended early" : ""}`];
  }

  run({ run }) {
    return run;
  }

  spotOf(run) {
    return this.ofRun.get(run) ?? null;
  }
}

/** Around the values, and around all that the batch may take there: so the axis stays as it is while results come in. */
function axisScale(values, described) {
  const { varied, isLogarithmic } = described;
  const there = values.filter((value) => value !== null);
  if ([...there, ...(varied?.values ?? [])].some((value) => typeof value !== "number")) return cellScale(there, described);
  return NumberScale.around([...there, varied?.low, varied?.high].filter(Number.isFinite), isLogarithmic, !varied);
}
