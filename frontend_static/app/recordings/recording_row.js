import { element, setText } from "../element.js";
import { showStar } from "./facts_panel.js";
import { metricFigure } from "./metric_words.js";
import { sparkline } from "./sparkline.js";
import { counted, durationWords, nameOf, sizeWords, startedWords, stateWord } from "./words.js";

/** One recording of the list; its parts stay the same elements while it goes on. */
export class RecordingRow {
  #picture = null;

  /** @param {object} acts {open, star, rename, note, remove, choose}, each gets the recording */
  constructor(recording, acts) {
    const act = (name) => () => acts[name](this.recording);
    this.choice = element("input", { type: "checkbox", tabindex: "-1", change: () => acts.choose(this.recording, this.choice.checked) });
    this.star = element("button", { type: "button", class: "star", tabindex: "-1", click: act("star") });
    this.link = element("td", { class: "row-picture" });
    this.error = element("td", { class: "row-picture" });
    this.name = element("span", { class: "recording-name" });
    this.state = element("span", { class: "recording-state" });
    this.scenario = element("span", { class: "recording-scenario" });
    this.started = element("td", { class: "recording-started" });
    this.duration = element("span", {});
    this.size = element("small", {});
    this.peak = figure();
    this.rms = figure();
    this.torque = figure();
    this.events = element("span", {});
    this.faults = element("small", {});
    this.tags = element("span", { class: "recording-tags" });
    this.note = element("span", { class: "recording-note" });
    const quiet = (text, name) => element("button", { type: "button", class: "quiet", tabindex: "-1", click: act(name) }, text);
    this.root = element(
      "tr",
      { "data-id": recording.id, click: (event) => !event.target.closest("button, input, label") && acts.open(this.recording) },
      element("td", { class: "row-choice" }, element("label", { title: "Lay it over the recording that you open" }, this.choice), this.star),
      this.link,
      this.error,
      element("th", { scope: "row" }, element("div", {}, this.name, this.state), this.scenario),
      this.started,
      element("td", { class: "row-number row-length" }, this.duration, this.size),
      ...[this.peak, this.rms, this.torque].map(({ cell }) => cell),
      element("td", { class: "row-number row-events" }, this.events, this.faults),
      element(
        "td",
        { class: "row-note-cell" },
        this.tags,
        this.note,
        element("div", { class: "row-acts" }, quiet("Open", "open"), quiet("Rename", "rename"), quiet("Note", "note"), quiet("Delete", "remove")),
      ),
    );
    this.show(recording);
  }

  show(recording) {
    this.recording = recording;
    const name = nameOf(recording);
    setText(this.name, recording.name || recording.scenario || "no name");
    this.name.title = name;
    const { text, tone } = stateWord(recording);
    setText(this.state, text);
    this.state.dataset.tone = tone;
    setText(this.scenario, recording.name === recording.scenario ? "" : recording.scenario);
    setText(this.started, startedWords(recording.started_at));
    setText(this.duration, durationWords(recording.duration_s));
    setText(this.size, sizeWords(recording.size_bytes));
    const metrics = recording.summary?.metrics;
    for (const [each, metric] of [[this.peak, "peak_error"], [this.rms, "rms_error"], [this.torque, "peak_torque"]])
      each.show(metricFigure(metrics, metric));
    setText(this.events, counted(recording.events, "event"));
    setText(this.faults, recording.faults ? counted(recording.faults, "fault") : "");
    this.tags.replaceChildren(...recording.tags.map((tag) => element("span", { class: "tag" }, tag)));
    setText(this.note, recording.note);
    this.note.title = recording.note;
    showStar(this.star, recording.starred);
    this.choice.setAttribute("aria-label", `Lay ${name} over the one that you open`);
    this.star.setAttribute("aria-label", `Star ${name}`);
    this.root.setAttribute("aria-label", name);
    this.#draw(recording.summary?.picture ?? null);
  }

  set isChosen(isChosen) {
    this.choice.checked = isChosen;
    this.root.classList.toggle("is-chosen", isChosen);
  }

  /** In the row that has the focus, and only there, Tab reaches the buttons. */
  set isReachable(isReachable) {
    this.root.tabIndex = isReachable ? 0 : -1;
    for (const control of this.root.querySelectorAll("button, input")) control.tabIndex = isReachable ? 0 : -1;
  }

  #draw(picture) {
    const known = JSON.stringify(picture?.time ?? null);
    if (known === this.#picture) return;
    this.#picture = known;
    if (!picture) {
      this.link.replaceChildren();
      return this.error.replaceChildren();
    }
    const { time, reference, link_position, error } = picture;
    const path = [
      { values: reference ?? [], colour: "reference", isDashed: true },
      { values: link_position ?? [], colour: "link" },
    ];
    this.link.replaceChildren(sparkline("link and reference", time, path));
    this.error.replaceChildren(sparkline("tracking error", time, [{ values: error ?? [], colour: "link" }]));
  }
}

function figure() {
  const value = element("span", {});
  const unit = element("small", {});
  const cell = element("td", { class: "row-number row-metric" }, value, unit);
  return {
    cell,
    show: (shown) => {
      setText(value, shown.figure);
      setText(unit, shown.figure === "–" ? "" : shown.unit);
    },
  };
}
