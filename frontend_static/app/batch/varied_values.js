import { endsOf } from "./scales.js";

const MOST_STD = 4; // standard deviations that an axis spans on either side

/**
 * What each varied field takes in a batch, as its document says: known before any run is done.
 *
 * @param {{scenario: object, vary: object[]}} document @param {(path: string) => boolean} isWhole whether a field takes whole numbers
 * @returns {Map<string, {values: any[]|null, low: number, high: number, isLogarithmic: boolean|null, bins: number|null}>} by path:
 *   `values` written down or on a grid; null for random ones, which are between `low` and `high`, in `bins` if they are cells;
 *   `isLogarithmic` is null where nothing says so
 */
export function variedValues({ scenario, vary }, isWhole) {
  const each = vary.flatMap((variation) => variation.members ?? variation.draws?.map((draw) => ({ ...draw, count: variation.count })) ?? [variation]);
  return new Map(each.map((varied) => [varied.path, described(varied, scenario, isWhole(varied.path))]));
}

function described(varied, scenario, isWhole) {
  const present = varied.factor ? (valueAt(scenario, varied.path) ?? 1) : 1;
  const scaled = (value) => (typeof value === "number" ? whole(present * value, isWhole) : value);
  if (varied.distribution) return drawn(varied.distribution, varied.count, scaled);
  const values = (varied.kind === "grid" ? onGrid(varied) : varied.values).map(scaled);
  const [low, high] = endsOf(values);
  return { values, low, high, isLogarithmic: varied.kind === "grid" ? varied.spacing === "log" : null, bins: null };
}

function onGrid({ low, high, count, spacing }) {
  const share = (place) => (count > 1 ? place / (count - 1) : 0);
  const value = spacing === "log" ? (place) => low * (high / low) ** share(place) : (place) => low + (high - low) * share(place);
  return Array.from({ length: count }, (_, place) => value(place));
}

function drawn({ kind, low, high, mean, std, within = MOST_STD }, count, scaled) {
  const reach = Math.min(within, MOST_STD) * std;
  const ends = (kind === "normal" ? [mean - reach, mean + reach] : [low, high]).map(scaled).sort((a, b) => a - b);
  return { values: null, low: ends[0], high: ends[1], isLogarithmic: kind === "log_uniform", bins: Math.max(2, Math.ceil(Math.sqrt(count))) };
}

function whole(value, isWhole) {
  return isWhole ? Math.round(value) : value;
}

function valueAt(scenario, path) {
  return path.split(".").reduce((part, name) => part?.[name], scenario);
}
