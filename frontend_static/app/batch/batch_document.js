/**
 * The batch document of what the form says: fields on grids and lists are crossed in their order, random ones are drawn
 * together, and that for each point of the grid.
 *
 * @param {object} scenario the base @param {import("./variation_row.js").VariationRow[]} rows
 * @param {{name: string, seed: number, noise: string, keep: string, draws: number, method: string}} asked
 * @returns {object} @throws {Error} with a sentence
 */
export function batchDocument(scenario, rows, { name, seed, noise, keep, draws, method }) {
  const vary = rows.filter(({ isRandom }) => !isRandom).map((row) => row.read());
  const random = rows.filter(({ isRandom }) => isRandom).map((row) => row.read());
  if (random.length) vary.push({ kind: "sample", count: draws, method, draws: random });
  return { name: name || nameFor(rows), scenario, vary, seed, noise, keep: { trajectories: keep } };
}

/** @returns {string} what a batch is called that nobody named: the fields it varies */
export function nameFor(rows) {
  const names = rows.map(({ field }) => field.title || field.label);
  return (names.join(" × ") || "batch").slice(0, 80);
}
