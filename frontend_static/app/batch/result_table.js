import { batchRoutes } from "./batch_routes.js";

const PAGE = 10_000;
const ALWAYS = ["run", "state", "reason"];
export const MOST_ROWS = 200_000;

/**
 * The results of one batch, column by column, as far as they are there and looked at.
 *
 * Event `change` when other rows or columns are at hand, or when there is a problem.
 */
export class ResultTable extends EventTarget {
  #columns = new Map();
  #wanted = new Set(ALWAYS);
  #asked = 0;

  constructor() {
    super();
    this.open(null);
  }

  /** Show another batch, or none. */
  open(id) {
    this.id = id;
    this.rows = 0;
    this.total = 0;
    this.problem = "";
    this.isLoading = false;
    this.#columns = new Map();
    this.#wanted = new Set(ALWAYS);
    this.#asked += 1;
  }

  /** @returns {any[]} the values of all rows; null for what is not there */
  column(name) {
    return this.#columns.get(name) ?? [];
  }

  has(names) {
    return names.every((name) => this.#columns.has(name));
  }

  /** Make sure of columns. */
  async need(names) {
    if (this.has(names) && this.has(ALWAYS)) return;
    for (const name of names) this.#wanted.add(name);
    await this.reload();
  }

  /** Fetch all wanted columns anew: rows of parts that are done by now may lie before others. */
  async reload() {
    if (this.id === null) return;
    const asked = (this.#asked += 1);
    const names = [...this.#wanted];
    const found = names.map(() => []);
    this.isLoading = true;
    try {
      for (let offset = 0, total = 1; offset < Math.min(total, MOST_ROWS); offset += PAGE) {
        const page = await batchRoutes.results(this.id, { offset, limit: PAGE, columns: names.join() });
        if (asked !== this.#asked) return;
        total = this.total = page.total;
        const places = names.map((name) => page.columns.indexOf(name));
        for (const row of page.rows) places.forEach((place, i) => found[i].push(row[place] ?? null));
        if (!page.rows.length) break;
      }
      this.#columns = new Map(names.map((name, i) => [name, found[i]]));
      this.rows = found[0].length;
      this.problem = "";
    } catch (refusal) {
      if (asked !== this.#asked) return;
      this.problem = refusal.message;
    }
    this.isLoading = false;
    this.dispatchEvent(new Event("change"));
  }
}
