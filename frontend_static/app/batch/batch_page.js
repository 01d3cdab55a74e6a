import { element, setText } from "../element.js";
import { Palette } from "../plots/palette.js";
import { BatchHead } from "./batch_head.js";
import { batchRoutes } from "./batch_routes.js";
import { Columns } from "./columns.js";
import { PictureChoice } from "./picture_choice.js";
import { PlotCanvas } from "./plot_canvas.js";
import { MOST_ROWS, ResultTable } from "./result_table.js";
import { RunPanel } from "./run_panel.js";
import { scenarioFields } from "./scenario_fields.js";
import { UnwellList } from "./unwell_list.js";
import { countWords, isActive } from "./words.js";

const RELOAD_MS = 1500;
const REST = 4; // times as long as the results took to fetch, before they are fetched again
const NOTHING = "No results yet. Choose fields on the left and start a batch, or open one of the list.";
const WITHOUT = {
  queued: "No results yet: it waits for the batches before it.",
  cancelled: "It was cancelled before its first part was done: it has no results. Resume computes them.",
  failed: "It failed before its first part was done: it has no results. Resume tries again.",
  running: "No results yet: the first part is under way. Code that is used for the first time is compiled before it, which can take a minute, and some minutes after an installation.",
};

/** The results of one batch: its head, what is drawn of them, the chosen run. */
export class BatchPage {
  #timer = null;
  #nextAt = 0;
  #seen = "";

  /** @param {object} desk {session, theme, resume}, see BatchHead */
  constructor({ session, theme, resume }) {
    this.batch = null;
    this.schema = null;
    this.isLost = false;
    this.table = new ResultTable();
    this.head = new BatchHead(resume);
    this.choice = new PictureChoice(() => this.#need());
    this.plot = new PlotCanvas(new Palette(theme), (run) => this.showRun(run));
    this.unwell = new UnwellList((run) => this.showRun(run));
    this.problem = element("p", { class: "form-problem", role: "status", hidden: true });
    this.empty = element("p", { class: "result-overlay" }, NOTHING);
    this.run = new RunPanel({ session, theme }, () => this.#closeRun());
    this.results = element("div", { class: "batch-results", hidden: true }, this.head.root, this.choice.root, this.problem, this.plot.readout, this.plot.root, this.unwell.root);
    this.root = element("div", { id: "batch-main" }, element("div", { class: "batch-middle" }, this.results, this.empty), this.run.root);
    this.table.addEventListener("change", () => this.#draw());
    theme.addEventListener("change", () => this.plot.draw());
  }

  /** Show a batch, or none. @param {string|null} id @param {import("../document/parameter_schema.js").ParameterSchema} schema */
  async open(id, schema) {
    if (id === this.table.id && !this.isLost) return;
    this.schema = schema;
    this.isLost = false;
    clearTimeout(this.#timer);
    this.#timer = null;
    this.#closeRun();
    this.table.open(id);
    this.batch = null;
    this.columns = null;
    this.#seen = "";
    this.plot.show(null);
    this.results.hidden = true;
    this.#tell(NOTHING);
    if (id === null) return;
    this.#tell("Loading…");
    try {
      const [batch, document] = await Promise.all([batchRoutes.batch(id), batchRoutes.document(id)]);
      if (id !== this.table.id) return;
      this.columns = new Columns(batch, scenarioFields(document.scenario, schema), document);
      this.choice.offer(this.columns);
      this.results.hidden = false;
      this.take(batch);
      if (!this.#seen) this.#need();
    } catch (refusal) {
      if (id !== this.table.id) return;
      this.isLost = true;
      this.#tell(refusal.message);
    }
  }

  /** Newer facts of the batch that is shown. */
  take(batch) {
    if (batch.id !== this.table.id) return;
    if (this.isLost) return void this.open(batch.id, this.schema);
    if (!this.columns) return;
    this.batch = batch;
    this.head.show(batch);
    const seen = `${batch.state} ${batch.progress?.done}`;
    if (seen === this.#seen && !this.table.problem) return;
    this.#seen = seen;
    if (!isActive(batch)) return this.#reload();
    this.#timer ??= setTimeout(() => this.#reload(), Math.max(0, this.#nextAt - performance.now()));
  }

  /** Ask for newer facts. */
  async look() {
    const batch = await batchRoutes.batch(this.table.id).catch(() => null); // the list says what is wrong
    if (batch) this.take(batch);
  }

  /** Show one run. */
  showRun(run) {
    this.plot.mark(run);
    this.run.open(this.batch, run, this.columns);
    this.run.root.scrollIntoView?.({ block: "nearest" });
  }

  #closeRun() {
    const hadFocus = this.run.root.contains(document.activeElement);
    this.run.open(null, null, null);
    this.plot.mark(null);
    if (hadFocus) this.plot.canvas.focus();
  }

  async #reload() {
    clearTimeout(this.#timer);
    this.#timer = null;
    const begun = performance.now();
    await Promise.all([this.table.need(this.#names()), this.table.isLoading ? null : this.table.reload()]);
    const ended = performance.now();
    this.#nextAt = ended + Math.max(RELOAD_MS, REST * (ended - begun));
  }

  #names() {
    return [...this.choice.names, ...(this.choice.kind === "refused" ? this.columns.paths : [])];
  }

  async #need() {
    if (this.table.has(this.#names())) return this.#draw();
    await this.table.need(this.#names());
  }

  #draw() {
    if (!this.columns) return;
    const { table } = this;
    const isList = this.choice.kind === "refused";
    setText(this.problem, table.problem || (table.total > MOST_ROWS ? `The first ${countWords(MOST_ROWS)} of ${countWords(table.total)} runs are drawn; the files have all of them.` : ""));
    this.problem.hidden = this.problem.textContent === "";
    this.choice.count(UnwellList.count(table));
    this.plot.root.hidden = isList;
    this.plot.readout.hidden = isList;
    this.unwell.root.hidden = !isList;
    if (table.problem && !table.rows) this.#tell("");
    if (!table.has(this.#names())) return;
    const sentence = this.#nothing(isList);
    this.#tell(sentence);
    if (isList) this.unwell.show(table, this.columns);
    else this.plot.show(sentence && !this.#hasAxes() ? null : this.choice.picture(table), !sentence);
  }

  /** A map has its axes before it has a result. */
  #hasAxes() {
    return isActive(this.batch) && this.choice.kind === "map" && this.columns.paths.length > 1;
  }

  /** @returns {string} why nothing can be drawn, "" if something can */
  #nothing(isList) {
    if (!this.table.rows) return WITHOUT[this.batch?.state] ?? "It has no results.";
    if (this.choice.kind === "map" && this.columns.paths.length < 2) return "A map needs two varied fields. This batch varies one: see the scatter plot.";
    if (!isList && !this.table.column("state").some((state) => state !== "refused")) return "Every run was refused: see “Not done” for the reasons.";
    return "";
  }

  #tell(sentence) {
    setText(this.empty, sentence);
    this.empty.hidden = sentence === "";
  }
}
