import { element, setText } from "../element.js";
import { compact } from "../quantity.js";

const MOST = 200;
const STATES = { ended: "ended early", refused: "refused" };

/** The runs that were refused or ended early, each with its reason and values; a click shows the run. */
export class UnwellList {
  /** @param {(run: number) => void} chosen */
  constructor(chosen) {
    this.chosen = chosen;
    this.caption = element("p", { class: "result-caption" });
    this.reasons = element("ul", { class: "refused-few" });
    this.body = element("tbody");
    this.head = element("tr");
    this.table = element("table", { class: "unwell" }, element("thead", {}, this.head), this.body);
    this.root = element("div", { class: "unwell-list", tabindex: "0", role: "region", "aria-label": "Runs that were refused or ended early", hidden: true }, this.caption, this.reasons, this.table);
  }

  /** @returns {number} how many there are @param {import("./result_table.js").ResultTable} table */
  static count(table) {
    return table.column("state").filter((state) => state in STATES).length;
  }

  show(table, columns) {
    const [runs, states, reasons] = ["run", "state", "reason"].map((name) => table.column(name));
    const places = states.flatMap((state, place) => (state in STATES ? [place] : []));
    places.sort((a, b) => (states[a] === states[b] ? runs[a] - runs[b] : states[a] === "refused" ? -1 : 1));
    const of = (state) => places.filter((place) => states[place] === state).length;
    const most = places.length > MOST ? ` The first ${MOST} are listed.` : "";
    setText(this.caption, places.length ? `${of("refused")} refused, ${of("ended")} ended early.${most}` : "None: every run went to its end.");
    this.reasons.replaceChildren(...common(places.map((place) => reasons[place])).map(([reason, count]) => element("li", {}, `${count} × ${reason}`)));
    this.table.hidden = places.length === 0;
    this.head.replaceChildren(...["run", "", ...columns.paths.map((path) => columns.describe(path).label), "why"].map((text) => (text ? element("th", { scope: "col" }, text) : element("td"))));
    this.body.replaceChildren(...places.slice(0, MOST).map((place) => this.#row(place, table, columns)));
  }

  #row(place, table, columns) {
    const run = table.column("run")[place];
    const values = columns.paths.map((path) => element("td", {}, columns.words(path, table.column(path)[place] ?? null, compact)));
    return element(
      "tr",
      { "data-run": run },
      element("th", { scope: "row" }, element("button", { type: "button", class: "quiet", "aria-label": `Show run ${run}`, click: () => this.chosen(run) }, String(run))),
      element("td", {}, STATES[table.column("state")[place]]),
      ...values,
      element("td", { class: "why" }, table.column("reason")[place] ?? ""),
    );
  }
}

/** @returns {[string, number][]} the most common reasons, without their numbers: runs differ in these */
function common(reasons) {
  const counts = new Map();
  for (const reason of reasons.filter(Boolean)) {
    const words = reason.replace(/-?\d+(\.\d+)?(e[+-]?\d+)?/g, "…");
    counts.set(words, { count: (counts.get(words)?.count ?? 0) + 1, reason: counts.has(words) ? words : reason });
  }
  return [...counts.values()].sort((a, b) => b.count - a.count).slice(0, 5).map(({ reason, count }) => [reason, count]);
}
