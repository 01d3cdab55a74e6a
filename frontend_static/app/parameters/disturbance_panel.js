import { element, setText } from "../element.js";
import { fixed } from "../quantity.js";
import { NumberRow } from "./number_row.js";
import { Panel } from "./panel.js";
import { Segmented } from "./segmented.js";

const SIDES = [
  { value: "link", text: "Link" },
  { value: "motor", text: "Motor" },
];

/**
 * The disturbance torques on link or motor. Its rows are the first constant and the first sine of the document's list;
 * all other terms stay untouched, and are counted.
 */
export class DisturbancePanel {
  #rows = new Map();

  constructor(layout, desk) {
    this.layout = layout;
    this.desk = desk;
    this.side = "link";
    this.panel = new Panel(layout);
    this.root = this.panel.root;
    this.sides = new Segmented("Where the disturbance acts", SIDES, (side) => this.#choose(side));
    this.rowList = element("div", { class: "rows" });
    this.more = element("p", { class: "panel-hint", hidden: true });
    this.panel.body.append(this.sides.root, this.rowList, this.more);
    this.#choose("link");
  }

  echo(change) {
    if (!this.desk.document.scenario) return;
    for (const row of this.#rowsOf(this.side)) row.echo(change);
    setText(this.panel.aside, this.#timing());
    const shown = new Set(this.layout.terms.map(({ kind }) => this.#first(kind)).filter(Boolean));
    const others = this.#terms().filter((term) => !shown.has(term)).length;
    this.more.hidden = others === 0;
    setText(this.more, `+ ${others} more term${others === 1 ? "" : "s"} in the scenario, kept`);
  }

  #choose(side) {
    this.side = side;
    this.sides.show(side);
    this.rowList.replaceChildren(...this.#rowsOf(side).map((row) => row.root));
    this.echo({ own: true });
  }

  #rowsOf(side) {
    if (!this.#rows.has(side)) {
      const rows = this.layout.terms.flatMap(({ kind, fields }) => fields.map((name) => this.#row(side, kind, name)));
      this.#rows.set(side, rows.filter(Boolean));
    }
    return this.#rows.get(side);
  }

  #row(side, kind, name) {
    const { schema, document, edits, baseline, hint } = this.desk;
    const field = schema.field(`disturbances.${side}`, name, kind);
    if (!field) return null;
    const isAmount = name !== "frequency_hz";
    const inList = (terms) => terms?.find((term) => term.kind === kind)?.[name] ?? (isAmount ? 0 : field.default);
    return new NumberRow(
      field,
      {
        path: `disturbances.${side}.${kind}.${name}`,
        read: () => inList(document.value(`disturbances.${side}`)),
        baseline: () => baseline.value(`disturbances.${side}`) && inList(baseline.value(`disturbances.${side}`)),
        write: (value, gesture) => edits.replace("disturbances", this.#with(side, kind, name, value), gesture),
      },
      hint,
    );
  }

  /** The document's disturbances with one value changed; a term that does not exist yet acts at once and for ever. */
  #with(side, kind, name, value) {
    const all = structuredClone(this.desk.document.value("disturbances"));
    let term = all[side].find((each) => each.kind === kind);
    if (!term) {
      term = {
        kind,
        start_s: 0,
        end_s: null,
        ...(kind === "sine" ? { amplitude: 0, frequency_hz: this.#default("frequency_hz"), phase: 0 } : {}),
      };
      all[side].push(term);
    }
    if (term.end_s !== null && term.end_s <= (this.desk.session.snapshot?.time_s ?? 0)) term.end_s = null;
    term[name] = value;
    return all;
  }

  #default(name) {
    return this.desk.schema.field(`disturbances.${this.side}`, name, "sine").default;
  }

  #terms() {
    return this.desk.document.value(`disturbances.${this.side}`) ?? [];
  }

  #first(kind) {
    return this.#terms().find((term) => term.kind === kind);
  }

  #timing() {
    const now = this.desk.session.snapshot?.time_s ?? 0;
    const start = Math.max(0, ...this.layout.terms.map(({ kind }) => this.#first(kind)?.start_s ?? 0));
    return start > now ? `from ${fixed(start, 1)} s` : "";
  }
}
