import { firstAtOrAfter } from "../session/telemetry_store.js";

/**
 * Two cursors for measuring: the first click sets A, the next B, a third begins anew. Values are those of the nearest
 * samples at the time of the click; where the picture has not every sample, the source is asked for them.
 *
 * Event `change`.
 */
export class MeasuringCursors extends EventTarget {
  /** @param {import("./time_window.js").TimeWindow} timeWindow @param {() => string[]} channels names of those to read */
  constructor(timeWindow, channels) {
    super();
    this.timeWindow = timeWindow;
    this.channels = channels;
    this.isOn = false;
    this.a = null;
    this.b = null;
    this.version = 0;
  }

  toggle() {
    this.isOn = !this.isOn;
    this.clear();
  }

  clear() {
    this.a = this.b = null;
    this.#changed();
  }

  set(time) {
    if (!this.isOn) return;
    const { picture, source } = this.timeWindow;
    const point = this.#read(picture, time);
    if (!point) return;
    if (picture.isExact === false) this.#refine(point, source.around(time), time);
    if (!this.a || this.b) [this.a, this.b] = [point, null];
    else this.b = point;
    this.#changed();
  }

  /** @returns {number|null} seconds from A to B */
  get span() {
    return this.a && this.b ? this.b.time - this.a.time : null;
  }

  /** @returns {number} change of a channel from A to B, NaN while there is none */
  difference(channel) {
    return this.a && this.b ? this.b.values.get(channel) - this.a.values.get(channel) : NaN;
  }

  draw(plot, palette, isTop) {
    for (const [letter, point] of [
      ["A", this.a],
      ["B", this.b],
    ]) {
      if (!point || point.time < plot.scales.x.min || point.time > plot.scales.x.max) continue;
      const { ctx, bbox } = plot;
      const x = Math.round(plot.valToPos(point.time, "x", true)) + 0.5;
      ctx.save();
      ctx.strokeStyle = ctx.fillStyle = palette.colour("text");
      ctx.lineWidth = devicePixelRatio;
      ctx.setLineDash([]);
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
      ctx.font = `600 ${11 * devicePixelRatio}px system-ui, sans-serif`;
      ctx.textBaseline = "top";
      ctx.textAlign = "left";
      if (isTop) ctx.fillText(letter, x + 4 * devicePixelRatio, bbox.top + 2 * devicePixelRatio);
      ctx.restore();
    }
  }

  async #refine(point, asked, time) {
    const picture = await asked;
    if (picture) Object.assign(point, this.#read(picture, time));
    this.#changed();
  }

  #read(picture, time) {
    const times = picture.time;
    if (!times.length) return null;
    const after = Math.min(firstAtOrAfter(times, time), times.length - 1);
    const nearest = after > 0 && time - times[after - 1] < times[after] - time ? after - 1 : after;
    return {
      time: times[nearest],
      values: new Map(this.channels().map((name) => [name, picture.column(name)[nearest]])),
    };
  }

  #changed() {
    this.version += 1;
    this.dispatchEvent(new Event("change"));
  }
}
