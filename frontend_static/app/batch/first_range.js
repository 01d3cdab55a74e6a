const COUNT = 21;
const SPREAD = 2;

/**
 * Where a newly chosen field varies before anybody says otherwise: from half to twice of what it is, or its usual range.
 *
 * @returns {{low: number, high: number, count: number, spacing: "linear"|"log"}}
 */
export function firstRange({ value, typical = [0, 1], low = -Infinity, high = Infinity, isLogarithmic, isWhole }) {
  const isPositive = typeof value === "number" && value > 0;
  const ends = isPositive ? [Math.max(low, value / SPREAD), Math.min(high, value * SPREAD)] : typical;
  const [from, to] = isWhole ? ends.map(Math.round) : ends.map((end) => Number(end.toPrecision(4)));
  const count = isWhole ? Math.min(COUNT, Math.max(2, to - from + 1)) : COUNT;
  return { low: from, high: to, count, spacing: isLogarithmic && from > 0 ? "log" : "linear" };
}
