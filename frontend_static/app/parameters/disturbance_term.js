import { element, setText } from "../element.js";
import { briefly } from "../quantity.js";
import { PartRows } from "./part_rows.js";

/** One disturbance: a line that says what it is, and its rows when it is opened. A quick one has its amount always. */
export class DisturbanceTerm {
  /** @param {import("./term_list.js").TermList} list @param {object} shape of layout.js @param {string|number} key names its
   *  rows @param {() => number} index its place in the document's list now, -1 while it does not exist */
  constructor(list, shape, key, index) {
    Object.assign(this, { list, shape, key, index });
    const rowsOf = () => new PartRows(list.desk, (name) => this.#place(name), list.torqueShare);
    this.amount = shape.isQuick ? rowsOf() : null;
    this.rows = rowsOf();
    this.rows.root.hidden = true;
    this.words = element("span", { class: "term-words" });
    this.more = element(
      "button",
      { type: "button", class: "quiet term-more", "aria-expanded": "false", click: () => this.open(!this.isOpen) },
      shape.isQuick ? element("span", { class: "unseen" }, `${shape.label}: `) : element("span", {}, shape.label),
      this.words,
    );
    this.remove = element(
      "button",
      { type: "button", class: "quiet remove", "aria-label": `Remove ${shape.label}`, click: () => list.remove(this) },
      "×",
    );
    this.line = element("div", { class: "term-line" }, this.more, this.remove);
    this.root = element(
      "div",
      { class: "term", "data-kind": shape.kind, "data-term": key },
      ...[this.amount?.root, this.line, this.rows.root].filter(Boolean),
    );
  }

  get isOpen() {
    return !this.rows.root.hidden;
  }

  open(isOpen) {
    this.rows.root.hidden = !isOpen;
    this.more.setAttribute("aria-expanded", String(isOpen));
  }

  echo(change) {
    const { kind, main, fields } = this.shape;
    const { part } = this.list;
    const now = this.list.terms[this.index()];
    const isOne = now?.kind === kind;
    this.amount?.echo({ part, kind, fields: [main], isPartial: true }, now, change);
    this.line.hidden = !isOne;
    if (!isOne) return this.open(false);
    const first = { name: main, when: () => !this.amount };
    const own = main ? [first, ...fields] : fields;
    this.rows.echo({ part, kind, fields: own }, now, change);
    const says = this.shape.says(now).slice(this.amount ? 1 : 0);
    setText(this.words, [...says, this.#times(now)].join(", "));
  }

  #place(name) {
    const { list } = this;
    const { kind, main } = this.shape;
    const { document, baseline } = list.desk;
    const nothing = name === main && this.amount ? 0 : undefined;
    const inList = (terms, index) => (terms?.[index]?.kind === kind ? terms[index][name] : nothing);
    const placeThen = (terms) => (this.amount ? terms?.findIndex((term) => term.kind === kind) : this.index());
    return {
      path: `${list.part}.${this.key}.${name}`,
      read: () => inList(document.value(list.part), this.index()),
      baseline: () => {
        const then = baseline.value(list.part);
        return then && inList(then, placeThen(then));
      },
      write: (value) => list.replace((terms) => this.#with(terms, name, value)),
    };
  }

  /** The list with one value of this term changed: a quick term that does not exist begins, one that is over acts again. */
  #with(terms, name, value) {
    const now = this.list.desk.session.snapshot?.time_s ?? 0;
    let term = terms[this.index()];
    if (!term) terms.push((term = this.list.fresh(this.shape)));
    if (name === this.shape.main && this.amount && term.end_s !== null && term.end_s <= now) term.end_s = null;
    term[name] = value;
    return terms;
  }

  #times({ start_s, end_s }) {
    if (start_s > 0 && end_s !== null) return `${briefly(start_s)} to ${briefly(end_s)} s`;
    if (end_s !== null) return `until ${briefly(end_s)} s`;
    return start_s > 0 ? `from ${briefly(start_s)} s` : "always";
  }
}
