import { element, setText } from "../element.js";
import { rest } from "../session/rest.js";
import { StaleNotice } from "./stale_notice.js";

/** Saves what runs under a name: a new one, or a new version of a known one. */
export class SavePanel {
  /** @param {import("./library.js").Library} library @param {string} what runs, in words */
  constructor(library, what) {
    this.library = library;
    this.names = element("datalist", { id: `names-of-${library.kind}` });
    this.name = element("input", {
      type: "text",
      list: this.names.id,
      "aria-label": `Name to save ${what} under`,
      placeholder: "name",
      maxlength: 80,
      autocomplete: "off",
      spellcheck: "false",
      keydown: (event) => event.key === "Enter" && this.#save(),
    });
    this.button = element("button", { type: "button", click: () => this.#save() }, "Save");
    this.problem = element("p", { class: "form-problem", role: "alert", hidden: true });
    this.stale = new StaleNotice(() => library.choose(this.name.value.trim()));
    this.root = element(
      "section",
      { class: "side-panel", "aria-label": `Save ${what}` },
      element("h2", {}, `Save ${what}`),
      element("div", { class: "form-row" }, this.name, this.names, this.button),
      this.stale.root,
      this.problem,
    );
    library.addEventListener("list", () => this.names.replaceChildren(...library.lines.map(({ name }) => new Option(name))));
  }

  async #save() {
    const name = this.name.value.trim();
    this.#say("");
    if (!name) return this.name.focus();
    const etag = this.library.chosen?.name === name ? this.library.chosen.etag : await this.#etagOf(name);
    const isKept = await this.stale.attempt((known) => this.library.save(name, {}, known), etag, (words) => this.#say(words));
    if (isKept) this.name.value = "";
  }

  /** The list may be searched, so the name may be taken though it is not shown. */
  async #etagOf(name) {
    const listed = await rest("GET", `/api/${this.library.kind}`).catch(() => []);
    return listed.find((line) => line.name === name)?.etag;
  }

  #say(words) {
    setText(this.problem, words);
    this.problem.hidden = !words;
  }
}
