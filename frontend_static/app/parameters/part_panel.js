import { Panel } from "./panel.js";
import { PanelNote } from "./panel_note.js";
import { PartRows } from "./part_rows.js";
import { placeIn } from "./place.js";
import { Segmented } from "./segmented.js";

/** The panel of one part of the document: which kind it is, and a row for each of that kind's parameters. */
export class PartPanel {
  /** @param {object} layout entry of layout.js @param {object} desk {schema, document, edits, baseline, hint, session} */
  constructor(layout, desk) {
    this.layout = layout;
    this.desk = desk;
    this.panel = new Panel(layout);
    this.root = this.panel.root;
    this.kinds = layout.kinds?.length > 1 ? this.#kindChoice() : null;
    this.note = new PanelNote();
    this.rows = new PartRows(desk, (name, kind, beside) => placeIn(desk, layout.part, name, kind, beside));
    this.panel.body.append(...[this.kinds?.root, this.note.root, this.rows.root].filter(Boolean));
  }

  /** Take the document as it is now. */
  echo(change) {
    const { layout } = this;
    const now = this.desk.document.value(layout.part);
    if (!now) return;
    this.kinds?.show(now.kind);
    const { fields } = layout.kinds ? (layout.kinds.find(({ kind }) => kind === now.kind) ?? {}) : layout;
    this.rows.echo({ part: layout.part, kind: now.kind, fields }, now, change);
  }

  #kindChoice() {
    const { layout, desk } = this;
    const options = layout.kinds.map(({ kind, label }) => ({
      value: kind,
      text: label,
      title: desk.schema.part(layout.part, kind)?.description,
    }));
    const [section, ...inner] = layout.part.split(".");
    const path = [...inner, "kind"].join(".");
    const choose = (kind) => this.note.whileDoing(desk.edits.change(section, { [path]: kind }));
    const choice = new Segmented(layout.title, options, choose, layout.columns);
    choice.root.dataset.path = `${layout.part}.kind`;
    return choice;
  }
}
