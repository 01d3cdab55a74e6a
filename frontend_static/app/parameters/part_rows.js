import { arrange, element } from "../element.js";
import { ChoiceRow } from "./choice_row.js";
import { ListRow } from "./list_row.js";
import { NumberRow } from "./number_row.js";
import { SamplesRow } from "./samples_row.js";

/**
 * The rows of one part of the document: those of its parameters that have an effect at present, in the layout's order,
 * then those that the layout does not know yet.
 */
export class PartRows {
  #made = new Map();

  /** @param {object} desk @param {(name: string, kind?: string) => object} placeOf where a row's value lives (ParameterRow)
   *  @param {number} [torqueShare] scales what is measured in N·m */
  constructor(desk, placeOf, torqueShare = 1) {
    this.desk = desk;
    this.placeOf = placeOf;
    this.torqueShare = torqueShare;
    this.root = element("div", { class: "rows" });
  }

  /** Show a part as it is now. @param {{part: string, kind?: string, fields?: any[], isPartial?: boolean}} shape */
  echo(shape, now, change) {
    const visible = this.#visible(shape, now);
    const rows = visible.map((entry) => this.#row(shape, entry));
    arrange(
      this.root,
      rows.map((row) => row.root),
    );
    for (const row of rows) row.echo?.(change);
  }

  #visible({ part, kind, fields = [], isPartial }, now) {
    const listed = fields.map((entry) => (typeof entry === "string" ? { name: entry } : entry));
    const names = this.desk.schema.names(part, kind);
    const isListed = (name) => listed.some((entry) => entry.name === name || entry.beside === name);
    const unlisted = isPartial ? [] : names.filter((name) => !isListed(name)).map((name) => ({ name }));
    const scenario = this.desk.document.scenario;
    return [...listed, ...unlisted].filter(
      ({ name, heading, when }) => (heading || names.includes(name)) && (!when || when(now, scenario)),
    );
  }

  #row({ part, kind }, entry) {
    const key = `${kind ?? ""}.${entry.heading ?? entry.name}`;
    if (!this.#made.has(key)) this.#made.set(key, entry.heading ? heading(entry) : this.#make(part, kind, entry));
    return this.#made.get(key);
  }

  #make(part, kind, { name, short, words, beside }) {
    const { schema, hint } = this.desk;
    const field = schema.field(part, name, kind);
    const own = field.unit === "N·m" && this.torqueShare !== 1 ? field.scaled(this.torqueShare) : field;
    const place = { ...this.placeOf(name, kind, beside), short, words };
    if (beside) return new SamplesRow(own, schema.field(part, beside, kind), place, hint);
    const Row = own.columns ? ListRow : own.choices ? ChoiceRow : NumberRow;
    return new Row(own, place, hint);
  }
}

function heading({ heading }) {
  return { root: element("p", { class: "row-heading" }, heading) };
}
