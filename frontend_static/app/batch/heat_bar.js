import { sequentialColour } from "../analyse/colour_scale.js";
import { fitted, line } from "./plot_axes.js";

const BAR_PX = 14;
const APART_PX = 26;
const LINE_PX = 22;
const PX_PER_TICK = 50;
const FONT = '11px system-ui, -apple-system, "Segoe UI", sans-serif';

/**
 * Say beside a map what its colours and marks mean.
 *
 * @param {object} box of the map @param {NumberScale|null} colours null while nothing has a colour @param {string} title
 * @param {{name: "ended"|"refused", text: string}[]} marks that the map has
 */
export function drawBar(ctx, { left, top, width, height }, colours, title, marks, palette) {
  const at = left + width + APART_PX;
  const tall = height - LINE_PX * marks.length - (marks.length ? 14 : 0);
  ctx.font = FONT;
  ctx.textBaseline = "middle";
  ctx.textAlign = "left";
  marks.forEach(({ name, text }, place) => {
    const y = top + height - 8 - LINE_PX * (marks.length - 1 - place);
    ctx.fillStyle = palette.colour("track");
    ctx.fillRect(at, y - 8, BAR_PX, 16);
    drawMark(ctx, at + BAR_PX / 2, y, 4, name, palette.colour("text"));
    ctx.fillStyle = palette.colour("axis-text");
    ctx.fillText(text, at + BAR_PX + 5, y);
  });
  if (!colours) return;
  for (let y = 0; y < tall; y += 1) {
    ctx.fillStyle = sequentialColour(1 - y / tall);
    ctx.fillRect(at, top + y, BAR_PX, Math.min(1.5, tall - y));
  }
  ctx.fillStyle = palette.colour("axis-text");
  for (const { at: share, text } of colours.ticks(Math.max(2, Math.floor(tall / PX_PER_TICK)))) ctx.fillText(text, at + BAR_PX + 5, top + (1 - share) * tall);
  ctx.save();
  ctx.translate(at - 9, top + tall / 2);
  ctx.rotate(-Math.PI / 2);
  ctx.textAlign = "center";
  ctx.fillText(fitted(ctx, title, tall), 0, 0);
  ctx.restore();
}

/** × for runs that ended early, / for refused ones. */
export function drawMark(ctx, x, y, reach, name, colour) {
  ctx.lineWidth = 1.5;
  ctx.strokeStyle = colour;
  line(ctx, x - reach, y + reach, x + reach, y - reach);
  if (name === "ended") line(ctx, x - reach, y - reach, x + reach, y + reach);
}
