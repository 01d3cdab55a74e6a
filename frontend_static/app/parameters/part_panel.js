import { element, setText } from "../element.js";
import { ChoiceRow } from "./choice_row.js";
import { NumberRow } from "./number_row.js";
import { Panel } from "./panel.js";
import { Segmented } from "./segmented.js";

/** The panel of one part of the document: which kind it is, and a row for each of that kind's parameters. */
export class PartPanel {
  #rows = new Map();
  #shown = "";

  /** @param {object} layout entry of layout.js @param {object} desk {schema, document, edits, baseline, hint, session} */
  constructor(layout, desk) {
    this.layout = layout;
    this.desk = desk;
    this.panel = new Panel(layout);
    this.root = this.panel.root;
    [this.section, ...this.inner] = layout.part.split(".");
    this.rowList = element("div", { class: "rows" });
    this.kinds = layout.kinds?.length > 1 ? this.#kindChoice() : null;
    this.other = element("p", { class: "panel-hint", hidden: true });
    this.panel.body.append(...[this.kinds?.root, this.other, this.rowList].filter(Boolean));
  }

  /** Take the document as it is now. */
  echo(change) {
    const now = this.desk.document.value(this.layout.part);
    if (!now) return;
    this.kinds?.show(now.kind);
    const offered = this.layout.kinds?.find((kind) => kind.kind === now.kind);
    this.#sayOther(now, offered);
    const shape = offered ?? this.layout.kinds?.[0] ?? this.layout;
    const visible = this.#visible(shape, now);
    const signature = `${shape.kind ?? ""}:${visible.map(({ name }) => name).join()}`;
    if (signature !== this.#shown) {
      this.#shown = signature;
      this.rowList.replaceChildren(...visible.map((entry) => this.#row(entry, shape.kind).root));
    }
    for (const entry of visible) this.#row(entry, shape.kind).echo(change);
  }

  /** The layout's fields that the schema has, then those that the layout does not know yet. */
  #visible(shape, now) {
    const listed = shape.fields.map((entry) => (typeof entry === "string" ? { name: entry } : entry));
    const names = this.desk.schema.names(this.layout.part, shape.kind);
    const unlisted = names.filter((name) => !listed.some((entry) => entry.name === name)).map((name) => ({ name }));
    return [...listed, ...unlisted].filter(({ name, when }) => names.includes(name) && (!when || when(now)));
  }

  #sayOther(now, offered) {
    const isOther = Boolean(this.layout.kinds) && !offered;
    this.other.hidden = !isOther;
    if (isOther)
      setText(
        this.other,
        `The scenario asks for “${now.kind}”. Setting a value here makes it “${this.layout.kinds[0].label.toLowerCase()}”.`,
      );
  }

  #row({ name, short }, kind) {
    const key = `${kind ?? ""}.${name}`;
    if (!this.#rows.has(key)) {
      const field = this.desk.schema.field(this.layout.part, name, kind);
      const Row = field.choices ? ChoiceRow : NumberRow;
      this.#rows.set(key, new Row(field, { ...this.#place(name, kind), short }, this.desk.hint));
    }
    return this.#rows.get(key);
  }

  #place(name, kind) {
    const { document, edits, baseline } = this.desk;
    const path = `${this.layout.part}.${name}`;
    const relative = [...this.inner, name].join(".");
    const kindPath = [...this.inner, "kind"].join(".");
    return {
      path,
      read: () => document.value(path),
      baseline: () => (kind && baseline.value(`${this.layout.part}.kind`) !== kind ? undefined : baseline.value(path)),
      write: (value, gesture) => {
        const switches = kind && document.value(`${this.layout.part}.kind`) !== kind;
        return edits.change(
          this.section,
          switches ? { [kindPath]: kind, [relative]: value } : { [relative]: value },
          gesture,
        );
      },
    };
  }

  #kindChoice() {
    const options = this.layout.kinds.map(({ kind, label }) => ({
      value: kind,
      text: label,
      title: this.desk.schema.part(this.layout.part, kind)?.description,
    }));
    const path = [...this.inner, "kind"].join(".");
    const choice = new Segmented(this.layout.title, options, (kind) =>
      this.desk.edits
        .change(this.section, { [path]: kind })
        .catch((refusal) => this.desk.session.note(refusal.message)),
    );
    choice.root.dataset.path = `${this.layout.part}.kind`;
    return choice;
  }
}
