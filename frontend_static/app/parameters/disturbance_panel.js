import { element } from "../element.js";
import { Panel } from "./panel.js";
import { Segmented } from "./segmented.js";
import { TermList } from "./term_list.js";

/** The disturbance torques on each of the three inertias: which one is shown, and the list of what acts there. */
export class DisturbancePanel {
  #lists = new Map();

  constructor(layout, desk) {
    this.layout = layout;
    this.desk = desk;
    this.panel = new Panel(layout);
    this.root = this.panel.root;
    this.sides = new Segmented("Where the disturbance acts", layout.sides, (side) => this.#choose(side));
    this.place = element("div");
    this.panel.body.append(this.sides.root, this.place);
    this.#choose(layout.sides[0].value);
  }

  echo(change) {
    const all = this.desk.document.value(this.layout.part);
    if (!all) return;
    for (const { value, text } of this.layout.sides)
      this.sides.label(value, all[value].length ? `${text} · ${all[value].length}` : text);
    this.#list().echo(change);
  }

  #choose(side) {
    this.side = side;
    this.sides.show(side);
    this.place.replaceChildren(this.#list().root);
    this.echo({ own: true });
  }

  #list() {
    if (!this.#lists.has(this.side)) {
      const side = this.layout.sides.find(({ value }) => value === this.side);
      this.#lists.set(this.side, new TermList(this.layout, side, this.desk));
    }
    return this.#lists.get(this.side);
  }
}
