import { element, setText } from "../element.js";
import { when } from "../presets/when.js";
import { batchAddress } from "./batch_routes.js";
import { showProgress } from "./progress.js";
import { STATES, countsWords, isPreparing, isResumable, rateWords, runsWords, sentence, spanWords } from "./words.js";

const FORMS = [
  ["parquet", "Parquet"],
  ["csv", "CSV"],
  ["arrow", "Arrow"],
];

export const RESUME = "Computes the runs that are missing; those that are there stay";

/** Above the results of a batch: what it is, how far it is, how its runs ended, and its files. */
export class BatchHead {
  /** @param {(id: string, hear: (problem: string) => void) => void} resume */
  constructor(resume) {
    this.batch = null;
    this.title = element("h2", { class: "batch-name", tabindex: "-1" });
    this.state = element("span", { class: "batch-state" });
    this.resume = element("button", { type: "button", title: RESUME, click: () => this.#resume(resume) }, "Resume");
    this.reason = element("p", { class: "batch-reason" });
    this.counts = element("p", { class: "result-caption" });
    this.problem = element("p", { class: "form-problem", role: "status", hidden: true });
    this.progress = element("progress", { max: 1, "aria-label": "Progress of the batch" });
    this.results = FORMS.map(([form, text]) => ({ form, link: element("a", { class: "export-link", download: true }, text) }));
    this.samples = element("a", { class: "export-link", download: true, title: "The samples that were kept, as Parquet" }, "samples");
    this.files = element("nav", { class: "batch-files", "aria-label": "Files of the results" }, ...this.results.map(({ link }) => link), this.samples);
    this.root = element("header", { class: "batch-head" }, element("div", { class: "batch-head-line" }, this.title, this.state, this.resume, this.files), this.progress, element("div", { role: "status" }, this.counts, this.reason), this.problem);
  }

  show(batch) {
    if (batch.id !== this.batch?.id || batch.state !== this.batch.state) this.#say("");
    this.batch = batch;
    setText(this.title, batch.name);
    this.title.title = batch.description || batch.name;
    setText(this.state, stateWords(batch));
    this.state.dataset.state = batch.state;
    setText(this.counts, `${runsWords(batch.runs)}: ${countsWords(batch.counts)}.`);
    setText(this.reason, sentence(batch.reason || (batch.waiting_for && `waits for ${batch.waiting_for}`)));
    this.reason.dataset.state = batch.state;
    this.reason.hidden = this.reason.textContent === "";
    this.#offer(isResumable(batch));
    showProgress(this.progress, batch);
    for (const { form, link } of this.results) link.href = batchAddress(batch.id, `results.${form}`);
    this.samples.href = batchAddress(batch.id, "trajectories.parquet");
    this.samples.hidden = !batch.trajectories || batch.trajectories === "none";
    this.files.hidden = !batch.progress?.done;
  }

  #offer(isResumable) {
    const hadFocus = document.activeElement === this.resume;
    this.resume.hidden = !isResumable;
    if (hadFocus && !isResumable) this.title.focus();
  }

  #resume(resume) {
    const { id } = this.batch;
    this.#say("");
    resume(id, (problem) => id === this.batch.id && this.#say(problem));
  }

  #say(problem) {
    setText(this.problem, problem);
    this.problem.hidden = problem === "";
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
