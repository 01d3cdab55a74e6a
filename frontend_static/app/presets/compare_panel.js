import { element, setText } from "../element.js";
import { DifferenceTable, changesText } from "./difference_table.js";

const LIVE = "live";

/** Two versions beside each other, or a version and what runs; from there it is applied, whole or in part. */
export class ComparePanel {
  #asked = 0;

  /** @param {import("./library.js").Library} library @param {(version: number, paths: string[]|null) => Promise<void>} apply
   *  @param {{title: string, isChoice: boolean, applyText: (count: number, isWhole: boolean) => string}} words */
  constructor(library, apply, { title, isChoice, applyText }) {
    this.library = library;
    this.apply = apply;
    this.applyText = applyText;
    this.version = element("select", { "aria-label": "Version", change: () => this.refresh() });
    this.against = element("select", { "aria-label": "Compared with", change: () => this.refresh() });
    this.table = new DifferenceTable(isChoice);
    this.table.addEventListener("change", () => this.#sayApply());
    this.words = element("p", { class: "hint", role: "status" });
    this.button = element("button", { type: "button", class: "start", "data-needs-control": true, hidden: true, click: () => this.#apply() }, "Apply");
    this.problem = element("p", { class: "form-problem", role: "alert", hidden: true });
    this.root = element(
      "section",
      { class: "detail-section" },
      element("h3", {}, title),
      element("div", { class: "form-row" }, this.version, element("span", { class: "hint" }, "compared with"), this.against),
      this.words,
      this.table.root,
      this.problem,
      element("div", { class: "form-row" }, this.button),
    );
    this.library.session.document.addEventListener("change", () => this.against.value === LIVE && this.refresh());
  }

  /** Show another document, or a newer state of it; what was compared stays so where it can. */
  show(found) {
    const isOther = found.name !== this.name;
    this.name = found.name;
    const [version, against] = [this.version.value, this.against.value];
    const numbers = found.versions.map(({ number, label }) => [number, `version ${number}${label ? ` “${label}”` : ""}`]).reverse();
    this.version.replaceChildren(...numbers.map(([number, text]) => new Option(text, number)));
    const others = this.library.lines.filter(({ name, archived }) => name !== found.name && !archived);
    this.against.replaceChildren(
      new Option("what runs", LIVE),
      group("versions", numbers),
      others.length ? group(`other ${this.library.kind}`, others.map(({ name }) => [`name:${name}`, name])) : "",
    );
    const isNewer = this.newest !== found.versions.length;
    this.newest = found.versions.length;
    choose(this.version, isOther || isNewer ? String(numbers[0][0]) : version);
    choose(this.against, isOther ? LIVE : against);
    this.refresh();
  }

  compare(version, against) {
    choose(this.version, String(version));
    choose(this.against, String(against));
    this.refresh();
    this.version.focus();
  }

  async refresh() {
    if (!this.name || this.root.closest("[hidden]")) return;
    const asked = (this.#asked += 1);
    const against = this.against.value.replace(/^name:/, "");
    let found;
    try {
      found = await this.library.difference(this.name, this.version.value, against);
    } catch (refusal) {
      return this.#say(refusal.message);
    }
    if (asked !== this.#asked) return;
    this.#say("");
    const shown = JSON.stringify([found, this.name, this.version.value, against]);
    if (shown === this.shown) return; // what is chosen stays chosen
    this.shown = shown;
    this.found = found;
    const isLive = this.against.value === LIVE;
    const from = isLive ? "runs now" : this.against.selectedOptions[0].text;
    this.table.show(found, from, `version ${this.version.value}`, this.table.isChoice && isLive);
    setText(this.words, found.same ? `The same${isLive ? " as what runs: nothing to apply" : ""}.` : "");
    this.words.hidden = !found.same;
    this.#sayApply();
  }

  #sayApply() {
    const count = this.table.isChoice ? this.table.chosen.length : this.found.changes.length;
    this.button.hidden = this.against.value !== LIVE || this.found.changes.length === 0;
    this.button.disabled = count === 0;
    setText(this.button, this.applyText(count));
  }

  async #apply() {
    const { chosen, isWhole, isChoice } = this.table;
    try {
      await this.apply(Number(this.version.value), !isChoice || (isWhole && !this.found.refused.length) ? null : chosen);
      this.#say("");
    } catch (refusal) {
      this.#say(refusal.message);
    }
    this.refresh();
  }

  #say(words) {
    setText(this.problem, words);
    this.problem.hidden = !words;
  }
}

export const applyChanges = (count) => `Apply ${changesText(count)}`;

function group(label, entries) {
  const made = element("optgroup", { label });
  made.append(...entries.map(([value, text]) => new Option(text, value)));
  return made;
}

function choose(select, value) {
  if ([...select.options].some((option) => option.value === value)) select.value = value;
}
