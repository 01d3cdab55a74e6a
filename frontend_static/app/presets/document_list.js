import { arrange, element, setText } from "../element.js";
import { whenBy } from "./when.js";

const REST_MS = 180;
const MOVES = { ArrowDown: 1, ArrowUp: -1 };

/** The searchable list of a library; arrow keys move, a click or Enter looks at one. */
export class DocumentList {
  #lines = new Map();
  #timer = 0;

  /** @param {import("./library.js").Library} library @param {string} empty what to do while there is none */
  constructor(library, empty) {
    this.library = library;
    this.search = element("input", {
      type: "search",
      "aria-label": `Search ${library.kind}`,
      placeholder: "search name, note, tags",
      autocomplete: "off",
      spellcheck: "false",
      input: () => this.#searchSoon(),
      keydown: (event) => event.key === "ArrowDown" && this.#move(event, -1, 1),
    });
    this.archive = element("input", { type: "checkbox", change: () => library.showArchive(this.archive.checked) });
    this.list = element("ol", { class: "document-list", keydown: (event) => this.#keyed(event) });
    this.problem = element("p", { class: "form-problem", role: "status", hidden: true });
    this.empty = element("p", { class: "hint", hidden: true });
    this.words = empty;
    this.root = element(
      "section",
      { class: "side-panel document-panel", "aria-label": `List of ${library.kind}` },
      element("div", { class: "form-row" }, this.search, element("label", {}, this.archive, " archive")),
      this.problem,
      this.list,
      this.empty,
    );
    for (const event of ["list", "chosen", "problem"]) library.addEventListener(event, () => this.#show());
  }

  #searchSoon() {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.library.find(this.search.value), REST_MS);
  }

  #keyed(event) {
    const at = [...this.list.children].findIndex((line) => line.contains(document.activeElement));
    if (MOVES[event.key]) this.#move(event, at, MOVES[event.key]);
  }

  #move(event, at, step) {
    event.preventDefault();
    (this.list.children[at + step]?.firstElementChild ?? (at + step < 0 ? this.search : null))?.focus();
  }

  #show() {
    const { library } = this;
    setText(this.problem, library.problem);
    this.problem.hidden = !library.problem;
    this.empty.hidden = library.lines.length > 0 || !library.isLoaded;
    const isSearch = this.search.value.trim() !== "";
    setText(this.empty, isSearch ? "None found." : library.showsArchive ? "The archive is empty." : this.words);
    const names = new Set(library.lines.map(({ name }) => name));
    for (const name of this.#lines.keys()) if (!names.has(name)) this.#lines.delete(name);
    for (const line of library.lines) {
      if (!this.#lines.has(line.name)) this.#lines.set(line.name, new Line(library, line.name));
      this.#lines.get(line.name).show(line, line.name === library.chosen?.name);
    }
    arrange(this.list, library.lines.map(({ name }) => this.#lines.get(name).root));
  }
}

/** One document of the list; it stays the same element, so that focus is kept. */
class Line {
  constructor(library, name) {
    this.name = element("span", { class: "document-name" }, name);
    this.version = element("span", { class: "document-version" });
    this.summary = element("span", { class: "document-summary" });
    this.tags = element("span", { class: "document-tags" });
    this.when = element("span", { class: "document-when" });
    this.button = element(
      "button",
      { type: "button", class: "document-line", click: () => library.choose(name) },
      this.name,
      this.version,
      this.summary,
      this.tags,
      this.when,
    );
    this.root = element("li", {}, this.button);
  }

  show(line, isChosen) {
    setText(this.version, line.versions === 1 ? "1 version" : `${line.versions} versions`);
    setText(this.summary, line.note || line.summary);
    this.summary.title = line.summary;
    setText(this.tags, line.tags.map((tag) => `#${tag}`).join(" "));
    setText(this.when, whenBy(line));
    this.name.title = line.name;
    if (isChosen) this.button.setAttribute("aria-current", "true");
    else this.button.removeAttribute("aria-current");
  }
}
