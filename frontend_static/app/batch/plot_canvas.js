import { element, setText } from "../element.js";
import { fitted } from "../plots/fitted_canvas.js";
import { Tip } from "../tip.js";
import { drawAxes, leftOf } from "./plot_axes.js";
import { drawKey } from "./plot_key.js";

const PAD = { left: 58, right: 22, top: 14, bottom: 46 };
const KEY_TOP = 24;
const LEGEND_PX = 92;
const MOST_LEFT = 0.25; // of the width, for the words on an axis

/**
 * A plot on a canvas: axes, a picture in them, and spots of it that are read under the pointer or by the arrow keys.
 *
 * A picture has `x`, `y` {scale, title}, `hasLegend`, `about` in words, `paint(ctx, box, palette)`, `legend(ctx, box, palette)`, `keys` (plot_key.js),
 * `hit(u, v, box)` and `move(spot, key)`: a spot or null, `where(spot)`: its [u, v], 0 to 1 from the lower left, `words(spot)`:
 * lines, `run(spot)`: the number of a run in it, and `spotOf(run)`.
 */
export class PlotCanvas {
  #spot = null;
  #pointer = null; // the latest event of a pointer over it

  /** @param {Palette} palette @param {(run: number) => void} chosen */
  constructor(palette, chosen) {
    this.palette = palette;
    this.chosen = chosen;
    this.picture = null;
    this.run = null;
    this.tip = new Tip();
    this.readout = element("output", { class: "result-readout", "data-idle": "A click shows the run there; arrow keys and Enter do so, too." });
    this.canvas = element("canvas", {
      class: "map-canvas batch-canvas",
      tabindex: "0",
      role: "img",
      "aria-label": "No results yet",
      pointermove: (event) => this.#point(event),
      pointerleave: () => this.#leave(),
      click: (event) => this.#choose(this.#spotAt(event)),
      keydown: (event) => this.#key(event),
      blur: () => this.#read(null),
    });
    this.root = element("div", { class: "map-area batch-plot" }, this.canvas);
    new ResizeObserver(() => this.draw()).observe(this.root);
  }

  /** Show a picture; the run that was read in the one before is read in this one, too. @param {object|null} picture
   *  @param {boolean} [hasRuns] whether there is something to click */
  show(picture, hasRuns = true) {
    const run = this.#spot === null ? null : this.picture.run(this.#spot);
    this.picture = picture;
    this.canvas.setAttribute("aria-label", picture ? `${picture.about} Arrow keys read it, Enter shows the run.` : "No results yet");
    this.readout.classList.toggle("is-idle", picture !== null && hasRuns);
    this.#read(run === null || !picture ? null : picture.spotOf(run));
    if (this.#pointer) this.#point(this.#pointer);
  }

  /** Mark the run that is shown. */
  mark(run) {
    this.run = run;
    this.draw();
  }

  draw() {
    const room = fitted(this.canvas, this.root);
    if (!room) return;
    const { ctx, width, height } = room;
    const { picture, palette } = this;
    if (!picture) return;
    const left = Math.min(MOST_LEFT * width, Math.max(PAD.left, leftOf(ctx, picture)));
    const right = picture.hasLegend ? LEGEND_PX : PAD.right;
    const top = picture.keys.length ? KEY_TOP : PAD.top;
    this.box = { left, top, width: Math.max(10, width - left - right), height: Math.max(10, height - top - PAD.bottom) };
    ctx.save();
    ctx.beginPath();
    ctx.rect(this.box.left, this.box.top, this.box.width, this.box.height);
    ctx.clip();
    picture.paint(ctx, this.box, palette);
    ctx.restore();
    drawAxes(ctx, this.box, picture, palette);
    drawKey(ctx, this.box, picture.keys, palette);
    if (picture.hasLegend) picture.legend(ctx, this.box, palette);
    const marked = this.run === null ? null : picture.spotOf(this.run);
    if (marked !== null) this.#ring(ctx, marked, 9);
    if (this.#spot !== null) this.#ring(ctx, this.#spot, 6);
  }

  #ring(ctx, spot, radius) {
    const [x, y] = this.#pixel(this.picture.where(spot));
    for (const [colour, width] of [
      ["#fff", 4],
      ["#111", 1.75],
    ]) {
      ctx.strokeStyle = colour;
      ctx.lineWidth = width;
      ctx.beginPath();
      ctx.arc(x, y, radius, 0, 2 * Math.PI);
      ctx.stroke();
    }
  }

  #pixel([u, v]) {
    const { left, top, width, height } = this.box;
    return [left + u * width, top + (1 - v) * height];
  }

  #spotAt(event) {
    if (!this.picture || !this.box) return null;
    const area = this.canvas.getBoundingClientRect();
    const { left, top, width, height } = this.box;
    const [u, v] = [(event.clientX - area.left - left) / width, 1 - (event.clientY - area.top - top) / height];
    return u < 0 || u > 1 || v < 0 || v > 1 ? null : this.picture.hit(u, v, this.box);
  }

  #leave() {
    this.#pointer = null;
    this.tip.hide();
  }

  #point(event) {
    this.#pointer = event;
    const spot = this.#spotAt(event);
    this.canvas.style.cursor = spot === null ? "default" : "pointer";
    this.tip.show(event.clientX, event.clientY, spot === null ? [] : this.picture.words(spot));
  }

  #key(event) {
    if (!this.picture) return;
    if (event.key === "Enter") return this.#choose(this.#spot);
    if (!event.key.startsWith("Arrow")) return;
    event.preventDefault();
    this.#read(this.picture.move(this.#spot, event.key));
  }

  #read(spot) {
    this.#spot = spot;
    setText(this.readout, spot === null || !this.picture ? "" : this.picture.words(spot).join(" · "));
    this.draw();
  }

  #choose(spot) {
    this.tip.hide();
    const run = spot === null || !this.picture ? null : this.picture.run(spot);
    if (run !== null && run !== undefined) this.chosen(run);
  }
}
