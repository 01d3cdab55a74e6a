import { element, setText } from "../element.js";
import { displayUnit, fixed, significant } from "../quantity.js";
import { dashOf } from "./ghosts.js";

const FIGURES = [
  { name: "peak_error", label: "peak" },
  { name: "rms_error", label: "RMS" },
];

/** The pinned runs beside the plots: their name, when, what was tuned, their error beside the live one; show, rename, let go. */
export class PinPanel {
  #lines = new Map();

  /** @param {import("./pinned_runs.js").PinnedRuns} runs @param {() => void} pin pins the window shown */
  constructor(runs, pin) {
    this.runs = runs;
    this.session = runs.session;
    this.pin = element(
      "button",
      { type: "button", title: "Keep the window shown beside the live run (P)", click: pin },
      "Pin the window ",
      element("kbd", {}, "P"),
    );
    this.live = element("p", { class: "pin-live" });
    this.empty = element("p", { class: "side-empty" }, "A pinned run stays behind the live one, pale and dashed: press P, then change the tuning.");
    this.list = element("ol", { class: "pin-list" });
    this.root = element("div", { class: "pin-panel" }, element("div", { class: "line" }, this.pin), this.live, this.empty, this.list);
    runs.addEventListener("change", () => this.#show());
    this.session.addEventListener("snapshot", () => this.#showLive());
    this.session.addEventListener("connection", () => this.#enable());
    this.#show();
  }

  #show() {
    const { list } = this.runs;
    for (const [id, line] of this.#lines) if (!list.some((run) => run.id === id)) (line.root.remove(), this.#lines.delete(id));
    for (const run of list) this.#line(run).show();
    this.empty.hidden = list.length > 0;
    this.#enable();
  }

  #line(run) {
    if (!this.#lines.has(run.id)) {
      const line = new PinLine(run, this.runs);
      this.#lines.set(run.id, line);
      this.list.prepend(line.root);
    }
    return this.#lines.get(run.id);
  }

  #showLive() {
    const { items = [], window_s } = this.session.snapshot?.metrics ?? {};
    const values = Object.fromEntries(items.map(({ name, value }) => [name, value]));
    setText(this.live, this.runs.list.length ? `live, last ${window_s} s: ${errorWords(values)}` : "");
  }

  #enable() {
    for (const control of this.root.querySelectorAll("button, input")) control.disabled = !this.session.isConnected;
  }
}

class PinLine {
  constructor(run, runs) {
    this.run = run;
    this.runs = runs;
    this.shown = element("input", { type: "checkbox", change: () => runs.show(run, this.shown.checked) });
    this.swatch = swatch(dashOf(run));
    this.name = element("input", {
      type: "text",
      class: "pin-name",
      "aria-label": "Name of the pinned run",
      maxlength: 200,
      spellcheck: "false",
      autocomplete: "off",
    });
    this.name.addEventListener("keydown", (event) => event.key === "Enter" && this.name.blur());
    this.name.addEventListener("blur", () => this.#rename());
    this.letGo = element("button", { type: "button", class: "quiet", title: "Let go of it; the recording stays", click: () => runs.letGo(run) }, "×");
    this.when = element("p", { class: "pin-when" });
    this.words = element("p", { class: "pin-words" });
    this.figures = element("p", { class: "pin-figures" });
    this.root = element(
      "li",
      { class: "pin-entry" },
      element("label", { class: "pin-shown" }, this.shown, this.swatch, element("span", { class: "unseen" }, "shown")),
      this.name,
      this.letGo,
      this.when,
      this.words,
      this.figures,
    );
  }

  show() {
    const { excerpt, problem } = this.run;
    this.shown.checked = excerpt.shown;
    this.root.classList.toggle("is-hidden", !excerpt.shown);
    if (document.activeElement !== this.name) this.name.value = excerpt.label;
    this.name.title = excerpt.label;
    this.letGo.setAttribute("aria-label", `Let go of ${excerpt.label}`);
    const isOurs = excerpt.by === this.runs.session.you && Date.parse(excerpt.created_at) > performance.timeOrigin;
    const by = isOurs ? "you" : excerpt.by; // a server that was restarted counts its pages anew
    const kind = excerpt.kind === "pin" ? "" : `${excerpt.kind}, `;
    const when = new Date(excerpt.created_at).toLocaleTimeString([], { hour12: false });
    setText(this.when, `${kind}${fixed(excerpt.from_s, 1)} to ${fixed(excerpt.to_s, 1)} s, ${when}, ${by}`);
    const words = excerpt.words.join(", ");
    this.words.hidden = !words || words === excerpt.label;
    setText(this.words, words);
    this.words.title = words;
    const isTrouble = excerpt.shown && problem !== "";
    setText(this.figures, isTrouble ? `No samples: ${problem}` : errorWords(excerpt.metrics));
    this.figures.classList.toggle("is-warning", isTrouble);
  }

  #rename() {
    const label = this.name.value.trim();
    if (label && label !== this.run.excerpt.label) this.runs.rename(this.run, label);
    else this.name.value = this.run.excerpt.label;
  }
}

function errorWords(values) {
  const { unit, factor } = displayUnit("rad");
  const known = FIGURES.filter(({ name }) => typeof values?.[name] === "number");
  return known.length ? `${known.map(({ name, label }) => `${label} ${significant(values[name] * factor)}`).join(", ")} ${unit}` : "";
}

/** A short line, dashed as the run's ghosts are. */
function swatch(dash) {
  const root = element("canvas", { class: "pin-swatch", width: 44, height: 4, "aria-hidden": "true" });
  const ctx = root.getContext("2d");
  ctx.strokeStyle = "#8a94a3";
  ctx.lineWidth = 4;
  ctx.setLineDash(dash.map((each) => 2 * each));
  ctx.moveTo(0, 2);
  ctx.lineTo(44, 2);
  ctx.stroke();
  return root;
}
