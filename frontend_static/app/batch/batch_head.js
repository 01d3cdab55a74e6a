import { element, setText } from "../element.js";
import { when } from "../presets/when.js";
import { batchAddress } from "./batch_routes.js";
import { showProgress } from "./progress.js";
import { STATES, countsWords, isPreparing, rateWords, runsWords, spanWords } from "./words.js";

const FORMS = [
  ["parquet", "Parquet"],
  ["csv", "CSV"],
  ["arrow", "Arrow"],
];

/** Above the results of a batch: what it is, how far it is, how its runs ended, and its files. */
export class BatchHead {
  constructor() {
    this.title = element("h2", { class: "batch-name" });
    this.state = element("span", { class: "batch-state" });
    this.counts = element("p", { class: "result-caption", role: "status" });
    this.progress = element("progress", { max: 1, "aria-label": "Progress of the batch" });
    this.results = FORMS.map(([form, text]) => ({ form, link: element("a", { class: "export-link", download: true }, text) }));
    this.samples = element("a", { class: "export-link", download: true, title: "The samples that were kept, as Parquet" }, "samples");
    this.files = element("nav", { class: "batch-files", "aria-label": "Files of the results" }, ...this.results.map(({ link }) => link), this.samples);
    this.root = element("header", { class: "batch-head" }, element("div", { class: "batch-head-line" }, this.title, this.state, this.files), this.progress, this.counts);
  }

  show(batch) {
    setText(this.title, batch.name);
    this.title.title = batch.description || batch.name;
    setText(this.state, stateWords(batch));
    this.state.dataset.state = batch.state;
    const reason = batch.reason ? ` ${batch.reason}` : "";
    setText(this.counts, `${runsWords(batch.runs)}: ${countsWords(batch.counts)}.${reason}`);
    showProgress(this.progress, batch);
    for (const { form, link } of this.results) link.href = batchAddress(batch.id, `results.${form}`);
    this.samples.href = batchAddress(batch.id, "trajectories.parquet");
    this.samples.hidden = !batch.trajectories || batch.trajectories === "none";
    this.files.hidden = !batch.progress?.done;
  }
}

function stateWords(batch) {
  const { state, progress, rate, seconds_left: left, seconds, ended_at: ended } = batch;
  if (isPreparing(batch)) return `preparing · ${spanWords(seconds)}`;
  if (state === "running") {
    const remaining = left === null || left === undefined ? "" : `${spanWords(left)} left`;
    return [`${Math.floor(100 * (progress?.share ?? 0))} %`, rateWords(rate), remaining].filter(Boolean).join(" · ");
  }
  const took = state === "done" ? `in ${spanWords(seconds)}` : "";
  return [STATES[state] ?? state, took, ended ? `, ${when(ended)}` : ""].filter(Boolean).join(" ").replace(" ,", ",");
}
