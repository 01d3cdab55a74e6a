/**
 * Make a canvas as large as its area, in pixels of the screen.
 * @returns {{ctx: CanvasRenderingContext2D, width: number, height: number}|null} to draw on in CSS pixels; null while the area is not shown
 */
export function fitted(canvas, { clientWidth: width, clientHeight: height }) {
  if (!width || !height) return null;
  canvas.width = Math.round(width * devicePixelRatio);
  canvas.height = Math.round(height * devicePixelRatio);
  const ctx = canvas.getContext("2d");
  ctx.scale(devicePixelRatio, devicePixelRatio);
  return { ctx, width, height };
}
