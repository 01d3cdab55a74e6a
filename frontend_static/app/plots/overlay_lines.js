import { firstAtOrAfter } from "../session/telemetry_store.js";
import { Envelope, Span } from "./envelope.js";
import { traced } from "./line_path.js";

/**
 * Other runs beneath the lines of one chart: each signal in its own colour, but paler and dashed in the way of its run.
 *
 * An overlay is {key, label, dash, alpha, shift, picture(range, pixels)}: `shift` s are added to its times. One that
 * `isSilent` has no values in the legends.
 */
export class OverlayLines {
  #shown = [];
  #envelopes = new Map();

  /** @param {object[]} series of the chart, as in chart_list.js */
  constructor(series) {
    this.series = series.filter(({ isFaint, isAlone }) => !isFaint && !isAlone);
  }

  /** Take the samples of the overlays for a span. @param {object[]} overlays @param {[number, number]} range s @param {number} pixels */
  measure(overlays, [from, to], pixels) {
    this.#shown = overlays.map((overlay) => {
      const range = [from - overlay.shift, to - overlay.shift];
      const picture = overlay.picture(range, pixels);
      return { overlay, picture, span: new Span(picture, range, pixels) };
    });
    for (const { overlay, picture, span } of this.#shown)
      for (const { channel } of this.series)
        this.#envelope(overlay, channel).measure(picture.column(channel), span);
  }

  /** @returns {Envelope[]} of what is shown at one side of the chart */
  envelopes(side) {
    const series = this.series.filter((each) => each.side === side && !each.isHidden);
    return this.#shown.flatMap(({ overlay }) => series.map(({ channel }) => this.#envelope(overlay, channel)));
  }

  /** @returns {{overlay: object, value: number}[]} a series' values of all overlays at a time of the chart */
  values(series, time) {
    const { channel, dash } = series;
    if (dash || !this.series.includes(series)) return [];
    const told = this.#shown.filter(({ overlay }) => !overlay.isSilent);
    return told.map(({ overlay, picture }) => {
      const own = time - overlay.shift;
      const isInside = picture.time.length > 0 && own >= picture.time[0] && own <= picture.time.at(-1);
      return { overlay, value: isInside ? picture.column(channel)[firstAtOrAfter(picture.time, own)] : NaN };
    });
  }

  draw(plot, palette) {
    const { ctx, bbox } = plot;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.lineWidth = 1.25 * devicePixelRatio;
    for (const { overlay, picture, span } of this.#shown) {
      ctx.setLineDash(overlay.dash.map((each) => each * devicePixelRatio));
      for (const { channel, side, colour, isHidden } of this.series) {
        if (isHidden) continue;
        const samples = { time: picture.time, values: picture.column(channel), first: span.first, last: span.last };
        ctx.strokeStyle = palette.faint(`series-${colour}`, overlay.alpha);
        ctx.stroke(traced(plot, side, this.#envelope(overlay, channel), samples, { shift: overlay.shift }));
      }
    }
    ctx.restore();
  }

  #envelope({ key }, channel) {
    const name = `${key} ${channel}`;
    if (!this.#envelopes.has(name)) this.#envelopes.set(name, new Envelope());
    return this.#envelopes.get(name);
  }
}
