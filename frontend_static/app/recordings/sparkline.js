import { svg } from "../svg.js";

const WIDTH = 108;
const HEIGHT = 30;
const PAD = 2;

/**
 * A small picture of signals over time, all on one scale.
 *
 * @param {string} label for screen readers @param {(number|null)[]} time @param {{values: (number|null)[], colour: string, isDashed?: boolean}[]} lines
 */
export function sparkline(label, time, lines) {
  const all = lines.flatMap(({ values }) => values).filter(Number.isFinite);
  const [low, high] = [Math.min(...all), Math.max(...all)];
  const [first, last] = [time[0], time.at(-1)];
  const x = (at) => ((at - first) / (last - first || 1)) * WIDTH;
  const y = (value) => PAD + (1 - (value - low) / (high - low || 1)) * (HEIGHT - 2 * PAD);
  const paths = lines.map(({ values, colour, isDashed }) =>
    svg("path", {
      d: traced(time, values, x, y),
      style: `stroke: var(--series-${colour})`,
      "stroke-dasharray": isDashed ? "3 2" : null,
    }),
  );
  return svg(
    "svg",
    { class: "sparkline", viewBox: `0 0 ${WIDTH} ${HEIGHT}`, width: WIDTH, height: HEIGHT, role: "img", "aria-label": label },
    ...paths,
  );
}

/** A gap breaks the line. */
function traced(time, values, x, y) {
  let path = "";
  let isDrawing = false;
  values.forEach((value, i) => {
    const isHere = Number.isFinite(value);
    if (isHere) path += `${isDrawing ? "L" : "M"}${x(time[i]).toFixed(1)} ${y(value).toFixed(1)}`;
    isDrawing = isHere;
  });
  return path;
}
