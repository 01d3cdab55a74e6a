import { arrange, element } from "../element.js";
import { PanelNote } from "./panel_note.js";
import { DisturbanceTerm } from "./disturbance_term.js";

/**
 * What acts on one side: first the quick terms, which have their row even before they exist, then all others, then the
 * choice of what to add.
 */
export class TermList {
  #others = new Map();

  /** @param {object} layout of the panel @param {{value: string, torqueShare?: number}} side @param {object} desk */
  constructor(layout, side, desk) {
    Object.assign(this, { layout, desk, side: side.value, torqueShare: side.torqueShare ?? 1 });
    this.part = `${layout.part}.${side.value}`;
    this.shapes = layout.terms.filter(({ kind }) => desk.schema.part(this.part, kind));
    this.quick = this.shapes
      .filter(({ isQuick }) => isQuick)
      .map((shape) => new DisturbanceTerm(this, shape, shape.kind, () => this.#first(shape.kind)));
    this.otherList = element("div");
    this.note = new PanelNote();
    this.root = element("div", { class: "terms" }, ...this.quick.map((term) => term.root), this.otherList);
    this.root.append(this.#adder(), this.note.root);
  }

  /** @returns {object[]} the terms of this side as the server last said them */
  get terms() {
    return this.desk.document.value(this.part) ?? [];
  }

  echo(change) {
    const quick = new Set(this.quick.map((term) => term.index()));
    const others = this.terms.flatMap((term, index) => (quick.has(index) ? [] : [this.#other(term.kind, index)]));
    for (const [key, other] of this.#others) if (!others.includes(other)) this.#others.delete(key);
    arrange(
      this.otherList,
      others.map((term) => term.root),
    );
    for (const term of [...this.quick, ...others]) term.echo(change);
    this.full.hidden = this.terms.length < this.longest;
    this.add.disabled = !this.full.hidden;
  }

  /** Change the list of this side. @param {(terms: object[]) => object[]} change gets a copy */
  replace(change) {
    const all = structuredClone(this.desk.document.value(this.layout.part));
    all[this.side] = change(all[this.side]);
    return this.desk.edits.replace(this.layout.part, all);
  }

  /** A new term of a kind, of a size that suits this side; what unfolds from its start starts now. */
  fresh({ kind, beginsNow }) {
    const made = this.desk.schema.defaults(this.part, kind);
    const now = this.desk.session.snapshot?.time_s ?? 0;
    for (const name of this.desk.schema.names(this.part, kind)) {
      const field = this.desk.schema.field(this.part, name, kind);
      made[name] = field.columns
        ? made[name].map((part) => Object.fromEntries(field.columns.map((own) => [own.name, this.#sized(own, part)])))
        : this.#sized(field, made);
    }
    return beginsNow ? { ...made, start_s: Math.ceil(now * 10) / 10 } : made;
  }

  async remove(term) {
    const gone = term.index();
    const isOpen = [...this.#others.values()].filter((other) => other.isOpen).map((other) => other.index());
    if (!(await this.note.whileDoing(this.replace((terms) => terms.filter((_, index) => index !== gone))))) return;
    for (const other of this.#others.values()) {
      const before = other.index() + (other.index() >= gone ? 1 : 0);
      other.open(isOpen.includes(before) && before !== gone);
    }
    this.kinds.focus();
  }

  #sized(field, part) {
    const value = part[field.name];
    return field.unit === "N·m" ? Number((value * this.torqueShare).toPrecision(3)) : value;
  }

  #first(kind) {
    return this.terms.findIndex((term) => term.kind === kind);
  }

  #other(kind, index) {
    const key = `${index}.${kind}`;
    if (!this.#others.has(key)) {
      const shape = this.layout.terms.find((each) => each.kind === kind) ?? { kind, label: kind, says: () => [] };
      this.#others.set(key, new DisturbanceTerm(this, { ...shape, isQuick: false }, index, () => index));
    }
    return this.#others.get(key);
  }

  #adder() {
    this.longest = this.desk.schema.longest(this.part);
    this.kinds = element(
      "select",
      { "aria-label": "Kind of disturbance to add" },
      ...this.shapes.map(({ kind, label }) => new Option(label, kind)),
    );
    this.add = element("button", { type: "button", click: () => this.#add() }, "Add");
    this.full = element("span", { class: "panel-hint", hidden: true }, `${this.longest} terms are all there may be.`);
    return element("div", { class: "line term-add" }, this.kinds, this.add, this.full);
  }

  async #add() {
    const shape = this.shapes.find(({ kind }) => kind === this.kinds.value);
    const index = this.terms.length;
    const isQuick = this.quick.some((term) => term.shape.kind === shape.kind && term.index() < 0);
    const added = await this.note.whileDoing(this.replace((terms) => [...terms, this.fresh(shape)]));
    if (added && !isQuick) this.#other(shape.kind, index).open(true);
  }
}
