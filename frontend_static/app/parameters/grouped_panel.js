import { element } from "../element.js";
import { Panel } from "./panel.js";
import { PartRows } from "./part_rows.js";
import { placeIn } from "./place.js";

/** A panel of several parts of the document, each under a heading. */
export class GroupedPanel {
  constructor(layout, desk) {
    this.desk = desk;
    this.panel = new Panel(layout);
    this.root = this.panel.root;
    this.groups = layout.groups.map((shape) => ({
      shape,
      rows: new PartRows(desk, (name, kind) => placeIn(desk, shape.part, name, kind)),
    }));
    for (const { shape, rows } of this.groups)
      this.panel.body.append(
        element("div", { role: "group", "aria-label": shape.title }, element("h3", {}, shape.title), rows.root),
      );
  }

  echo(change) {
    for (const { shape, rows } of this.groups) {
      const now = this.desk.document.value(shape.part);
      if (now) rows.echo(shape, now, change);
    }
  }
}
