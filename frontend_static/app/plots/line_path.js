/**
 * A uPlot path builder for evenly sampled telemetry. Where several samples share a pixel column it draws that column's
 * first, lowest, highest and last value, so no peak is lost; a NaN breaks the line.
 *
 * @param {{envelope: import("./envelope.js").Envelope, sign?: number, isShown?: () => boolean}} options `sign` -1 mirrors
 */
export function linePath({ envelope, sign = 1, isShown = () => true }) {
  return (plot, index, first, last) => {
    if (!isShown()) return null;
    const samples = { time: plot.data[0], values: plot.data[index], first, last };
    const stroke = traced(plot, plot.series[index].scale, envelope, samples, { sign });
    return { stroke, fill: null, clip: null, band: null, gaps: null, flags: 0 };
  };
}

/** @returns {Path2D} the line of some samples in a plot; `shift` s are added to their times */
export function traced(plot, scale, envelope, { time, values, first, last }, { sign = 1, shift = 0 } = {}) {
  const { left, top, width, height } = plot.bbox;
  const { x, [scale]: y } = plot.scales;
  const perUnit = height / (y.max - y.min);
  const place = {
    left,
    from: x.min - shift,
    perSecond: width / (x.max - x.min),
    zero: top + height + perUnit * y.min,
    perUnit: sign * perUnit,
  };
  const path = new Path2D();
  if (envelope.columns) traceColumns(path, envelope, place);
  else traceSamples(path, time, values, first, last, place);
  return path;
}

function traceColumns(path, { values, columns, low, high, isBroken }, { left, zero, perUnit }) {
  let isDrawing = false;
  for (let column = 0; column < low.length; column += 1) {
    const [start, end] = [columns[column], columns[column + 1]];
    if (start === end) continue;
    if (isBroken[column]) {
      isDrawing = false;
      continue;
    }
    const x = left + column;
    const opening = values[start];
    if (isDrawing) path.lineTo(x, zero - opening * perUnit);
    else path.moveTo(x, zero - opening * perUnit);
    isDrawing = true;
    if (end - start === 1) continue;
    path.lineTo(x, zero - low[column] * perUnit);
    path.lineTo(x, zero - high[column] * perUnit);
    path.lineTo(x, zero - values[end - 1] * perUnit);
  }
}

function traceSamples(path, time, values, first, last, { left, from, perSecond, zero, perUnit }) {
  let isDrawing = false;
  for (let i = first; i <= last; i += 1) {
    const value = values[i];
    if (Number.isNaN(value)) {
      isDrawing = false;
      continue;
    }
    const x = left + (time[i] - from) * perSecond;
    const y = zero - value * perUnit;
    if (isDrawing) path.lineTo(x, y);
    else path.moveTo(x, y);
    isDrawing = true;
  }
}
