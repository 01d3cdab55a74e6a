import { element } from "../element.js";
import { ComparePanel, applyChanges } from "./compare_panel.js";
import { DetailHead } from "./detail_head.js";
import { VersionTable } from "./version_table.js";

/** A preset: what is said about it, what applying it would change, and its versions. */
export class PresetDetail {
  constructor(library, session) {
    this.library = library;
    this.head = new DetailHead(library);
    this.compare = new ComparePanel(
      library,
      (version, paths) => session.command("apply_preset", { name: library.chosen.name, version, ...(paths && { paths }) }),
      { title: "Difference", isChoice: true, applyText: applyChanges },
    );
    this.versions = new VersionTable(library, this.head, (version, against) => this.compare.compare(version, against));
    this.root = element("div", { class: "detail" }, this.head.root, this.compare.root, this.versions.root);
  }

  show(found) {
    this.head.show(found);
    this.compare.show(found);
    this.versions.show(found);
  }

  /** Shown again: what runs may have changed meanwhile. */
  look() {
    this.compare.refresh();
  }
}
