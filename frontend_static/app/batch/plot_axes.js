const FONT = 'system-ui, -apple-system, "Segoe UI", sans-serif';
const PX_PER_TICK = [84, 44];
const APART_PX = 8;

/** Draw the frame of a plot with ticks, units and names. @param {object} picture its `x` and `y`: {scale, title} */
export function drawAxes(ctx, { left, top, width, height }, { x, y }, palette) {
  ctx.strokeStyle = palette.colour("control-line");
  ctx.lineWidth = 1;
  ctx.strokeRect(left - 0.5, top - 0.5, width + 1, height + 1);
  ctx.fillStyle = palette.colour("axis-text");
  ctx.font = `11px ${FONT}`;
  ctx.textAlign = "center";
  ctx.textBaseline = "top";
  let free = -Infinity;
  for (const { at, text } of x.scale.ticks(Math.max(2, Math.floor(width / PX_PER_TICK[0])))) {
    const [px, half] = [left + at * width, ctx.measureText(text).width / 2];
    line(ctx, px, top + height, px, top + height + 4);
    if (px - half < free) continue;
    ctx.fillText(text, px, top + height + 7);
    free = px + half + APART_PX;
  }
  ctx.textAlign = "right";
  ctx.textBaseline = "middle";
  for (const { at, text } of y.scale.ticks(Math.max(2, Math.floor(height / PX_PER_TICK[1])))) {
    const py = top + (1 - at) * height;
    line(ctx, left - 4, py, left, py);
    ctx.fillText(fitted(ctx, text, left - 24), left - 7, py);
  }
  ctx.fillStyle = palette.colour("text");
  ctx.font = `12px ${FONT}`;
  ctx.textAlign = "center";
  ctx.fillText(fitted(ctx, x.title, width), left + width / 2, top + height + 33);
  ctx.save();
  ctx.translate(11, top + height / 2);
  ctx.rotate(-Math.PI / 2);
  ctx.fillText(fitted(ctx, y.title, height), 0, 0);
  ctx.restore();
}

/** @returns {number} room that the y axis needs for its name and ticks, px */
export function leftOf(ctx, { y }) {
  ctx.font = `11px ${FONT}`;
  return 32 + Math.max(0, ...y.scale.ticks(10).map(({ text }) => ctx.measureText(text).width));
}

/** @returns {string} a text no wider than so many pixels; its end, which has the unit, stays */
export function fitted(ctx, text, width) {
  if (ctx.measureText(text).width <= width) return text;
  const unit = text.match(/ \[.*\]$/)?.[0] ?? "";
  let shown = text.slice(0, text.length - unit.length);
  while (shown.length > 3 && ctx.measureText(`${shown}…${unit}`).width > width) shown = shown.slice(0, -1);
  return `${shown.trim()}…${unit}`;
}

export function line(ctx, x0, y0, x1, y1) {
  ctx.beginPath();
  ctx.moveTo(x0, y0);
  ctx.lineTo(x1, y1);
  ctx.stroke();
}
