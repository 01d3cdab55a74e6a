import { element, setText } from "../element.js";
import { displayUnit, significant } from "../quantity.js";

const SMALL_TORQUE = 1e-3;

/** The figures of merit over the last seconds; every number keeps its place. */
export class Metrics {
  #shown = new Map();

  constructor(session) {
    this.session = session;
    this.list = document.getElementById("metrics");
    session.addEventListener("snapshot", () => this.#show());
  }

  #show() {
    const { items = [], window_s } = this.session.snapshot.metrics ?? {};
    const names = items.map((item) => item.name).join();
    if (names !== this.names) this.#build(items, names);
    for (const { name, value, unit, description } of items) {
      const { figure, unitMark, root } = this.#shown.get(name);
      const shown = metricUnit(unit, value);
      setText(figure, significant(value === null ? value : value * shown.factor));
      setText(unitMark, shown.unit);
      root.title = [description, window_s ? `over the last ${window_s} s` : ""].filter(Boolean).join("; ");
    }
  }

  #build(items, names) {
    this.names = names;
    this.#shown = new Map(items.map((item) => [item.name, metric(item)]));
    this.list.replaceChildren(...[...this.#shown.values()].map(({ root }) => root));
  }
}

function metric({ label, unit }) {
  const figure = element("span", { class: "metric-figure" });
  const unitMark = element("span", { class: "metric-unit" }, displayUnit(unit).unit);
  const root = element(
    "div",
    { class: "metric" },
    element("dt", {}, label),
    element("dd", {}, figure, unitMark),
  );
  return { root, figure, unitMark };
}

/** The usual unit; a thousandth of it where a torque is so small that its digits would be zeros. */
function metricUnit(unit, value) {
  return unit === "N·m" && Math.abs(value) < SMALL_TORQUE ? { factor: 1e3, unit: "mN·m" } : displayUnit(unit);
}
