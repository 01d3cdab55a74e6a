/**
 * A uPlot path builder for dense, evenly sampled telemetry: where several samples share a pixel column, it draws that
 * column's first, lowest, highest and last value, so no peak is lost; a NaN breaks the line.
 *
 * @param {{sign?: number, isShown?: () => boolean}} options `sign` -1 mirrors the line
 */
export function linePath({ sign = 1, isShown = () => true } = {}) {
  return (plot, index, first, last) => {
    if (!isShown()) return null;
    const stroke = new Path2D();
    const time = plot.data[0];
    const values = plot.data[index];
    const { left, top, width, height } = plot.bbox;
    const x = plot.scales.x;
    const y = plot.scales[plot.series[index].scale];
    const perSecond = width / (x.max - x.min);
    const perUnit = (sign * height) / (y.max - y.min);
    const bottom = top + height + (height * y.min) / (y.max - y.min);
    trace(stroke, time, values, first, last, (t) => left + (t - x.min) * perSecond, (v) => bottom - v * perUnit);
    return { stroke, fill: null, clip: null, band: null, gaps: null, flags: 0 };
  };
}

function trace(path, time, values, first, last, xOf, yOf) {
  let column = NaN;
  let isDrawing = false;
  let opening = 0;
  let low = 0;
  let high = 0;
  let closing = 0;
  let count = 0;
  const flush = () => {
    if (count > 1) {
      if (low !== opening) path.lineTo(column, low);
      if (high !== low) path.lineTo(column, high);
      if (closing !== high) path.lineTo(column, closing);
    }
    count = 0;
  };
  for (let i = first; i <= last; i += 1) {
    const value = values[i];
    if (Number.isNaN(value)) {
      flush();
      isDrawing = false;
      column = NaN;
      continue;
    }
    const pixel = Math.round(xOf(time[i]));
    const y = yOf(value);
    if (pixel === column) {
      if (y < low) low = y;
      if (y > high) high = y;
      closing = y;
      count += 1;
      continue;
    }
    flush();
    if (isDrawing) path.lineTo(pixel, y);
    else path.moveTo(pixel, y);
    isDrawing = true;
    column = pixel;
    opening = low = high = closing = y;
    count = 1;
  }
  flush();
}

/** Widen [low, high] to hold the samples of a span; NaN counts for nothing. @returns {[number, number]} */
export function extent(values, first, last, low = Infinity, high = -Infinity) {
  for (let i = first; i <= last; i += 1) {
    const value = values[i];
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return [low, high];
}
