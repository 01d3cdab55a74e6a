import { element, setText } from "../element.js";

/** Files in and out: an import shows what was found before it is kept. */
export class ImportPanel {
  #file = null;

  /** @param {import("./library.js").Library} library */
  constructor(library) {
    this.library = library;
    this.picker = element("input", { type: "file", accept: ".json,application/json", class: "unseen", tabindex: "-1", "aria-hidden": "true", change: () => this.#look() });
    this.name = element("input", { type: "text", "aria-label": "Name for what has none in the file", placeholder: "name for it", maxlength: 80, hidden: true, change: () => this.#ask() });
    this.found = element("ul", { class: "import-found", hidden: true });
    this.problem = element("p", { class: "form-problem", role: "alert", hidden: true });
    this.keep = element("button", { type: "button", class: "start", hidden: true, click: () => this.#keep() });
    this.cancel = element("button", { type: "button", class: "quiet", hidden: true, click: () => this.#clear() }, "Cancel");
    this.root = element(
      "section",
      { class: "side-panel", "aria-label": "Files" },
      element("h2", {}, "Files"),
      element(
        "div",
        { class: "form-row" },
        element("button", { type: "button", click: () => this.picker.click() }, "Import…"),
        element("a", { class: "button-link", href: library.exportAddress(), download: "" }, "Export all"),
        this.picker,
      ),
      this.problem,
      this.name,
      this.found,
      element("div", { class: "form-row" }, this.keep, this.cancel),
    );
  }

  async #look() {
    const [file] = this.picker.files;
    this.picker.value = "";
    if (!file) return;
    this.#clear();
    try {
      this.#file = JSON.parse(await file.text());
    } catch (error) {
      return this.#say(`${file.name} is not JSON: ${error.message}. Expected an exported file.`);
    }
    this.name.value = file.name.replace(/\.json$/i, "").replace(/^vssea-(preset|actuator)s?-?/, "");
    this.#ask();
  }

  async #ask() {
    const isNameless = !Array.isArray(this.#file) && typeof this.#file === "object" && !("name" in this.#file) && !(this.library.kind in this.#file);
    this.name.hidden = !isNameless;
    this.cancel.hidden = false;
    try {
      this.#show((await this.library.take(this.#file, this.name.value.trim(), true))[this.library.kind]);
      this.#say("");
    } catch (refusal) {
      this.#say(refusal.message);
    }
  }

  #show(entries) {
    this.found.hidden = false;
    this.found.replaceChildren(...entries.map((entry) => element("li", {}, ...this.#words(entry).map(([tone, text]) => element("p", { "data-tone": tone }, text)))));
    const count = entries.reduce((sum, entry) => sum + entry.new, 0);
    const isGood = entries.every(({ refused }) => refused.length === 0);
    this.keep.hidden = !isGood || count === 0;
    setText(this.keep, `Keep ${count} version${count === 1 ? "" : "s"}`);
  }

  #words({ name, versions, new: fresh, exists, unknown, missing, refused }) {
    const of = versions === 1 ? "1 version" : `${versions} versions`;
    const becomes = fresh === 0 ? "all of it is here already" : exists ? `${fresh} of them new, added to the one here` : "new here";
    const words = [["plain", `${name}: ${of}, ${becomes}`]];
    if (refused.length) words.push(["warning", `Does not fit, so nothing can be kept: ${refused.map(({ field, message }) => `${field}, ${message}`).join("; ")}`]);
    if (unknown.length) words.push(["dim", `Unknown, left out: ${unknown.join(", ")}`]);
    if (missing.length) words.push(["dim", `Missing, taken as the default: ${missing.join(", ")}`]);
    return words;
  }

  async #keep() {
    try {
      const answer = await this.library.take(this.#file, this.name.value.trim(), false);
      this.#clear();
      await this.library.choose(answer[this.library.kind][0].name);
    } catch (refusal) {
      this.#say(refusal.message);
    }
  }

  #clear() {
    this.#say("");
    this.found.replaceChildren();
    for (const part of [this.found, this.keep, this.cancel, this.name]) part.hidden = true;
  }

  #say(words) {
    setText(this.problem, words);
    this.problem.hidden = !words;
  }
}
