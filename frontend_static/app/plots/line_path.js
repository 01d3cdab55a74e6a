/**
 * A uPlot path builder for evenly sampled telemetry. Where several samples share a pixel column it draws that column's
 * first, lowest, highest and last value, so no peak is lost; a NaN breaks the line.
 *
 * @param {{envelope: import("./envelope.js").Envelope, sign?: number, isShown?: () => boolean}} options `sign` -1 mirrors
 */
export function linePath({ envelope, sign = 1, isShown = () => true }) {
  return (plot, index, first, last) => {
    if (!isShown()) return null;
    const { left, top, width, height } = plot.bbox;
    const { x, [plot.series[index].scale]: y } = plot.scales;
    const perUnit = height / (y.max - y.min);
    const place = {
      left,
      from: x.min,
      perSecond: width / (x.max - x.min),
      zero: top + height + perUnit * y.min,
      perUnit: sign * perUnit,
    };
    const stroke = new Path2D();
    if (envelope.columns) traceColumns(stroke, envelope, place);
    else traceSamples(stroke, plot.data[0], plot.data[index], first, last, place);
    return { stroke, fill: null, clip: null, band: null, gaps: null, flags: 0 };
  };
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
