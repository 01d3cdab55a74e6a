import { element, setText } from "../element.js";
import { EditableText } from "./editable_text.js";
import { StaleNotice } from "./stale_notice.js";
import { whenBy } from "./when.js";

/** Name, note and tags of what is looked at, changed where they stand; archive and export. */
export class DetailHead {
  /** @param {import("./library.js").Library} library */
  constructor(library) {
    this.library = library;
    const edit = (changes, etag) => this.attempt((known) => library.edit(changes, known), etag);
    const begin = () => library.chosen?.etag;
    this.name = new EditableText("Name", (name, etag) => (name ? edit({ name }, etag) : this.#back()), { begin });
    this.name.root.classList.add("detail-name");
    this.note = new EditableText("Note", (note, etag) => edit({ note }, etag), {
      begin,
      placeholder: "note: what it is good for",
      isLong: true,
      maxlength: 2000,
    });
    this.tags = new EditableText("Tags, with commas between them", (text, etag) => edit({ tags: split(text) }, etag), {
      begin,
      placeholder: "tags, with commas",
      maxlength: 400,
    });
    this.meta = element("p", { class: "detail-meta" });
    this.fit = element("p", { class: "detail-fit", hidden: true });
    this.problem = element("p", { class: "form-problem", role: "alert", hidden: true });
    this.archive = element("button", { type: "button", class: "quiet", click: () => edit({ archived: !library.chosen.archived }, begin()) });
    this.export = element("a", { class: "button-link", download: "" }, "Export");
    this.stale = new StaleNotice(() => library.choose(library.chosen.name));
    this.root = element(
      "header",
      { class: "detail-head" },
      element("div", { class: "detail-title" }, this.name.root, this.export, this.archive),
      this.meta,
      this.note.root,
      this.tags.root,
      this.fit,
      this.stale.root,
      this.problem,
    );
  }

  /** Make a change of the state with this ETag; say why not, or what others changed. @returns {Promise<boolean>} */
  attempt(change, etag = this.library.chosen.etag) {
    this.say("");
    return this.stale.attempt(change, etag, (words) => this.say(words));
  }

  say(words) {
    setText(this.problem, words);
    this.problem.hidden = !words;
  }

  show(found) {
    if (found.name !== this.shown) {
      this.stale.hide();
      this.say("");
      this.shown = found.name;
    }
    this.name.show(found.name);
    this.note.show(found.note);
    this.tags.show(found.tags.join(", "));
    const label = found.label ? ` “${found.label}”` : "";
    const made = found.scenario ? `, made with ${found.scenario}` : "";
    setText(this.meta, `version ${found.version}${label} of ${found.versions.length}${made} · ${whenBy(found)} · ${found.summary}`);
    setText(this.archive, found.archived ? "Take out of the archive" : "Archive");
    this.export.href = this.library.exportAddress(found.name);
    const { unknown, missing, refused } = found.fit;
    const words = [
      refused.length && `does not fit: ${refused.map(({ field, message }) => `${field} (${message})`).join(", ")}`,
      unknown.length && `unknown: ${unknown.join(", ")}`,
      missing.length && `missing, taken as the default: ${missing.join(", ")}`,
    ].filter(Boolean);
    setText(this.fit, words.length ? `Saved by another version of the program. ${words.join("; ")}.` : "");
    this.fit.hidden = words.length === 0;
  }

  #back() {
    this.name.box.value = this.library.chosen.name;
    return false;
  }
}

function split(text) {
  return [...new Set(text.split(",").map((tag) => tag.trim().replace(/^#/, "")))].filter(Boolean);
}
