import { arrange, element, setText } from "../element.js";
import { when } from "../presets/when.js";
import { RESUME } from "./batch_head.js";
import { OneStop } from "./one_stop.js";
import { showProgress } from "./progress.js";
import { STATES, countWords, isActive, isPreparing, isResumable, rateWords, runsWords, sentence, spanWords } from "./words.js";

/** The list of batches: how far each is, at what rate, how long still, why it failed; cancel, resume, delete, and open one. */
export class BatchList {
  #lines = new Map();
  #isListed = false;
  #awaited = null; // the batch that gets the focus

  /** @param {import("./batches.js").Batches} batches @param {object} ask AskDialog @param {(id: string) => void} open */
  constructor(batches, ask, open) {
    this.batches = batches;
    this.ask = ask;
    this.open = open;
    this.list = element("ol", { class: "batch-list" });
    this.stop = new OneStop(this.list);
    this.problem = element("p", { class: "form-problem", role: "status", hidden: true });
    this.empty = element("p", { class: "hint" }, "Loading…");
    this.title = element("h2", {}, "Batches");
    this.root = element("section", { class: "side-panel batch-list-panel", "aria-label": "Batches" }, this.title, this.problem, this.list, this.empty);
    batches.addEventListener("list", () => this.#show());
    batches.addEventListener("problem", () => {
      setText(this.problem, batches.problem);
      this.problem.hidden = batches.problem === "";
    });
  }

  /** Mark the one whose results are shown. */
  mark(id) {
    const isOther = id !== this.marked;
    this.marked = id;
    this.#mark();
    if (isOther) this.#reveal();
  }

  #mark() {
    for (const [own, line] of this.#lines) line.mark(own === this.marked);
    this.stop.arrange(this.#lines.get(this.marked)?.root ?? null);
  }

  /** Bring the marked one in sight, in the list alone: the page stays where it is. */
  #reveal() {
    const line = this.#lines.get(this.marked)?.root;
    if (!line) return;
    const [top, bottom] = [this.title.getBoundingClientRect().bottom, this.root.getBoundingClientRect().bottom];
    const own = line.getBoundingClientRect();
    this.root.scrollTop += Math.min(0, own.top - top) + Math.max(0, own.bottom - bottom);
  }

  #show() {
    const { list, total } = this.batches;
    const known = new Set(list.map(({ id }) => id));
    for (const id of this.#lines.keys()) if (!known.has(id)) this.#lines.delete(id);
    for (const batch of list) {
      if (!this.#lines.has(batch.id)) this.#lines.set(batch.id, new BatchLine(this));
      this.#lines.get(batch.id).show(batch);
    }
    arrange(this.list, list.map(({ id }) => this.#lines.get(id).root));
    setText(this.empty, list.length ? `The newest ${list.length} of ${total}.` : "None yet. Choose fields above and start one: it is kept here with its results.");
    this.empty.hidden = list.length > 0 && total <= list.length;
    this.#mark();
    if (!this.#isListed && list.length) this.#reveal();
    this.#isListed = list.length > 0;
    if (this.#awaited !== null) this.focus(this.#awaited);
  }

  async remove(batch) {
    const text = `${runsWords(batch.runs)} and their results. They cannot be brought back.`;
    if (!(await this.ask.sure(`Delete ${batch.name}?`, text, "Delete"))) return;
    const ids = this.batches.list.map(({ id }) => id);
    const place = ids.indexOf(batch.id);
    await this.batches.remove(batch.id);
    if (document.activeElement === document.body) this.focus(ids[place + 1] ?? ids[place - 1]);
  }

  /** Give a batch the focus, as soon as it is listed. */
  focus(id) {
    const line = this.#lines.get(id);
    this.#awaited = line ? null : id;
    line?.title.focus();
  }
}

/** One batch; its parts stay the same elements, so that focus is kept while it goes on. */
class BatchLine {
  constructor(list) {
    this.title = element("button", { type: "button", class: "batch-title", click: () => list.open(this.batch.id) });
    this.state = element("span", { class: "task-state" });
    this.resume = element("button", { type: "button", class: "quiet", title: RESUME, click: () => list.batches.resume(this.batch.id) }, "Resume");
    this.cancel = element("button", { type: "button", class: "quiet", click: () => list.batches.cancel(this.batch.id) }, "Cancel");
    this.delete = element("button", { type: "button", class: "quiet", click: () => list.remove(this.batch) }, "Delete");
    this.progress = element("progress", { max: 1, "aria-label": "Progress" });
    this.words = element("p", { class: "task-reason" });
    this.reason = element("p", { class: "task-reason batch-reason" });
    this.root = element("li", { class: "batch" }, element("div", { class: "task-line" }, this.title, this.state, this.resume, this.cancel, this.delete), this.progress, this.words, this.reason);
  }

  mark(isShown) {
    this.root.classList.toggle("is-shown", isShown);
    if (isShown) this.title.setAttribute("aria-current", "true");
    else this.title.removeAttribute("aria-current");
  }

  show(batch) {
    this.batch = batch;
    const active = isActive(batch);
    this.root.dataset.state = batch.state;
    this.root.dataset.id = batch.id;
    setText(this.title, batch.name);
    this.title.title = `${batch.name}, ${when(batch.created_at)}`;
    setText(this.state, stateWord(batch));
    const focused = document.activeElement;
    const isOffered = [[this.resume, isResumable(batch)], [this.cancel, active], [this.delete, !active]];
    for (const [button, isShown] of isOffered) {
      button.setAttribute("aria-label", `${button.textContent} ${batch.name}`);
      button.hidden = !isShown;
      if (!isShown && button === focused) this.title.focus();
    }
    showProgress(this.progress, batch);
    setText(this.words, lineWords(batch));
    setText(this.reason, sentence(batch.reason));
    this.reason.dataset.state = batch.state;
    this.reason.hidden = !batch.reason;
  }
}

function stateWord(batch) {
  if (isPreparing(batch)) return "preparing";
  return batch.state === "running" ? `${Math.floor(100 * (batch.progress?.share ?? 0))} %` : (STATES[batch.state] ?? batch.state);
}

/** @returns {string} the second line: rate and time left while it runs, else when it was made and what became of it */
export function lineWords(batch) {
  if (batch.state === "running") {
    const left = batch.seconds_left === null || batch.seconds_left === undefined ? "" : `${spanWords(batch.seconds_left)} left`;
    return [runsWords(batch.runs), rateWords(batch.rate), left].filter(Boolean).join(" · ");
  }
  if (batch.state === "queued") return `${runsWords(batch.runs)} · waits for the batches before it`;
  const { done = 0 } = batch.progress ?? {};
  const runs = batch.state === "done" ? runsWords(batch.runs) : `${countWords(done)} of ${runsWords(batch.runs)}`;
  return [runs, when(batch.created_at), batch.state === "done" ? spanWords(batch.seconds) : ""].filter(Boolean).join(" · ");
}
