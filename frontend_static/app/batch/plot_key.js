import { line } from "./plot_axes.js";

const FONT = '12px system-ui, -apple-system, "Segoe UI", sans-serif';
const UP_PX = 11;
const REACH_PX = 4;
const HATCH_PX = 6;

/** Say in a line over a plot what its marks mean. @param {{text: string, colour: string, shape: "dot"|"cross"|"bar"|"hatched"}[]} keys */
export function drawKey(ctx, { left, top }, keys, palette) {
  ctx.font = FONT;
  ctx.textAlign = "left";
  ctx.textBaseline = "middle";
  let x = left;
  for (const { text, colour, shape } of keys) {
    mark(ctx, x + 6, top - UP_PX, shape, palette.colour(colour));
    ctx.fillStyle = palette.colour("text");
    ctx.fillText(text, x + 16, top - UP_PX + 1);
    x += 34 + ctx.measureText(text).width;
  }
}

/** A bar of slanted lines. */
export function hatched(ctx, x, y, width, height, colour) {
  ctx.save();
  ctx.lineWidth = 1;
  ctx.strokeStyle = colour;
  ctx.strokeRect(x + 0.5, y + 0.5, Math.max(0, width - 1), Math.max(0, height - 1));
  ctx.beginPath();
  ctx.rect(x, y, width, height);
  ctx.clip();
  for (let at = -height; at < width; at += HATCH_PX) line(ctx, x + at, y + height, x + at + height, y);
  ctx.restore();
}

/** Two crossed lines about a place. */
export function crossed(ctx, x, y, reach) {
  line(ctx, x - reach, y - reach, x + reach, y + reach);
  line(ctx, x - reach, y + reach, x + reach, y - reach);
}

function mark(ctx, x, y, shape, colour) {
  ctx.fillStyle = ctx.strokeStyle = colour;
  ctx.lineWidth = 1.5;
  if (shape === "cross") crossed(ctx, x, y, REACH_PX);
  else if (shape === "bar") ctx.fillRect(x - REACH_PX, y - REACH_PX, 2 * REACH_PX, 2 * REACH_PX);
  else if (shape === "hatched") hatched(ctx, x - 6, y - 6, 12, 12, colour);
  else {
    ctx.beginPath();
    ctx.arc(x, y, REACH_PX, 0, 2 * Math.PI);
    ctx.fill();
  }
}
