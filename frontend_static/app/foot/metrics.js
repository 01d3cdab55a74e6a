import { element, setText } from "../element.js";
import { displayUnit, significant } from "../quantity.js";

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
      const { figure, root } = this.#shown.get(name);
      setText(figure, significant(value === null ? value : value * displayUnit(unit).factor));
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
  const root = element(
    "div",
    { class: "metric" },
    element("dt", {}, label),
    element("dd", {}, figure, element("span", { class: "metric-unit" }, displayUnit(unit).unit)),
  );
  return { root, figure };
}
