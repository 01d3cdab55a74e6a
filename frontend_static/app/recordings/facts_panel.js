import { element, setText } from "../element.js";
import { CommitBox } from "../parameters/commit_box.js";
import { fixed } from "../quantity.js";
import { metricWords } from "./metric_words.js";
import { readTags, sizeWords, startedWords, durationWords, stateWord } from "./words.js";

const NOTE_PATIENCE_MS = 800;

/** What is known of the open recording; name, note and tags can be changed. */
export class FactsPanel {
  #timer = null;

  /** @param {(changes: object) => Promise<object>} change asks the server @param {(starred: boolean) => void} star */
  constructor(change) {
    this.change = change;
    this.name = new CommitBox("Name", (name) => this.#ask({ name: name.trim() }), { maxlength: 120 });
    this.tags = new CommitBox("Tags, with commas between them", (text) => this.#ask({ tags: readTags(text) }), { placeholder: "none" });
    this.star = element("button", { type: "button", class: "star", click: () => this.#ask({ starred: !this.facts.starred }) });
    this.note = element("textarea", {
      "aria-label": "Note",
      rows: 3,
      maxlength: 4000,
      placeholder: "What was tried, what came of it",
      input: () => this.#typed(),
      blur: () => this.#saveNote(),
    });
    this.problem = element("p", { class: "form-problem", role: "status", hidden: true });
    this.facts = null;
    this.lines = element("dl", { class: "facts" });
    this.metrics = element("dl", { class: "facts" });
    this.tunings = element("ol", { class: "tunings" });
    this.changes = element("section", { class: "side-panel", "aria-label": "Tunings" }, element("h2", {}, "Tunings"), this.tunings);
    this.root = element(
      "div",
      { class: "facts-column", tabindex: "0", role: "group", "aria-label": "Facts of the recording" },
      element(
        "section",
        { class: "side-panel", "aria-label": "Recording" },
        element("h2", {}, "Recording"),
        element("div", { class: "form-row" }, this.name.root, this.star),
        this.lines,
        element("div", { class: "form-row" }, element("span", { class: "form-name" }, "tags"), this.tags.root),
        this.note,
        this.problem,
      ),
      element("section", { class: "side-panel", "aria-label": "Metrics of the recording" }, element("h2", {}, "Metrics"), this.metrics),
      this.changes,
    );
  }

  show(facts) {
    const isOther = this.facts?.id !== facts.id;
    if (isOther) this.#saveNote();
    this.facts = facts;
    this.name.show(facts.name);
    this.tags.show(facts.tags.join(", "));
    if (isOther || (this.#timer === null && document.activeElement !== this.note)) this.note.value = facts.note;
    showStar(this.star, facts.starred);
    this.lines.replaceChildren(...factLines(facts));
    const metrics = metricWords(facts.summary?.metrics);
    this.metrics.replaceChildren(
      ...(metrics.length ? metrics.flatMap(({ label, words }) => pair(label, words)) : [element("dd", { class: "hint" }, "They are computed when the recording ends.")]),
    );
    this.tunings.replaceChildren(...facts.tunings.map(tuningLine));
    this.changes.hidden = facts.tunings.length === 0;
  }

  #typed() {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#saveNote(), NOTE_PATIENCE_MS);
  }

  #saveNote() {
    clearTimeout(this.#timer);
    this.#timer = null;
    if (this.facts && this.note.value !== this.facts.note) this.#ask({ note: this.note.value });
  }

  async #ask(changes) {
    let sentence = "";
    try {
      await this.change(this.facts.id, changes);
    } catch (refusal) {
      sentence = refusal.message;
    }
    setText(this.problem, sentence);
    this.problem.hidden = sentence === "";
  }
}

/** @param {HTMLButtonElement} button the star of a recording */
export function showStar(button, isStarred) {
  button.setAttribute("aria-pressed", String(isStarred));
  button.setAttribute("aria-label", "Star");
  button.title = isStarred ? "Starred: kept for good. Click to take the star away" : "Star: keep it for good";
  setText(button, isStarred ? "★" : "☆");
}

function factLines(facts) {
  const { text } = stateWord(facts);
  const rate = facts.samples > 1 ? (facts.samples - 1) / (facts.to_s - facts.from_s) : NaN;
  const lines = [
    ["scenario", facts.scenario?.name ?? facts.scenario],
    ["started", startedWords(facts.started_at)],
    ["duration", durationWords(facts.duration_s)],
    ["size", sizeWords(facts.size_bytes)],
    ["samples", `${facts.samples.toLocaleString("en").replaceAll(",", " ")} at ${fixed(rate, 0)} Hz`],
    ...(facts.lost ? [["lost", `${facts.lost} samples, shown as gaps`]] : []),
    ...(text ? [["state", text]] : []),
  ];
  return lines.flatMap(([name, value]) => pair(name, value));
}

function pair(name, value) {
  return [element("dt", {}, name), element("dd", {}, value)];
}

function tuningLine({ at_s, by, words }) {
  return element(
    "li",
    {},
    element("time", {}, `${fixed(at_s, 2)} s`),
    element("span", {}, words.join("; ")),
    by ? element("span", { class: "log-who" }, by) : null,
  );
}
