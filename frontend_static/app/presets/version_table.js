import { element } from "../element.js";
import { EditableText } from "./editable_text.js";
import { when } from "./when.js";

/** All versions of a document, newest first: named where they stand, compared, restored. */
export class VersionTable {
  /** @param {import("./detail_head.js").DetailHead} head that makes the changes
   *  @param {(version: number, against: number|"live") => void} compare */
  constructor(library, head, compare) {
    this.library = library;
    this.head = head;
    this.compare = compare;
    this.body = element("tbody");
    const heads = ["", "name", "saved", "by", "what it holds", ""].map((text) => element("th", { scope: "col" }, text));
    this.root = element(
      "section",
      { class: "detail-section" },
      element("h3", {}, "Versions"),
      element("table", { class: "version-table" }, element("thead", {}, element("tr", {}, ...heads)), this.body),
    );
  }

  show(found) {
    const shown = JSON.stringify([found.name, found.versions]);
    if (shown === this.shown || this.body.contains(document.activeElement?.closest?.("input.editable"))) return;
    this.shown = shown;
    this.body.replaceChildren(...[...found.versions].reverse().map((version) => this.#row(version, found.versions.length)));
  }

  #row(version, count) {
    const { number } = version;
    const label = new EditableText(
      `Name of version ${number}`,
      (text, begun) => this.head.attempt((etag) => this.library.edit({ labels: { [number]: text || null } }, etag), begun),
      { placeholder: "name it", maxlength: 120, begin: () => this.library.chosen.etag },
    );
    label.show(version.label ?? "");
    const isNewest = number === Math.max(...this.library.chosen.versions.map((each) => each.number));
    const button = (text, title, click) => element("button", { type: "button", class: "quiet", title, click }, text);
    return element(
      "tr",
      {},
      element("th", { scope: "row" }, String(number)),
      element("td", {}, label.root),
      element("td", { title: version.saved_at }, when(version.saved_at)),
      element("td", {}, version.author),
      element("td", { class: "version-summary", title: version.summary }, version.note || version.summary),
      element(
        "td",
        { class: "version-actions" },
        count > 1
          ? button("Compare", isNewest ? "With the version before it" : "With the newest version", () =>
              isNewest ? this.compare(number, number - 1) : this.compare(this.library.chosen.versions.at(-1).number, number),
            )
          : null,
        isNewest
          ? null
          : button("Restore", "Make it the newest version; the others stay", () =>
              this.head.attempt((etag) => this.library.restore(number, etag)),
            ),
      ),
    );
  }
}
