import { element, setText } from "../element.js";
import { TaskBoard } from "./task_board.js";

/** @returns {string} address of a task's report */
export function reportAddress({ id }) {
  return `/api/tasks/${id}/files/index.html`;
}

/** The paper's figures and claims, reproduced by the server as a report of its own. */
export class PaperSection {
  constructor(board) {
    this.board = board;
    this.problem = "";
    this.start = element("button", { type: "button", class: "start", click: () => this.#ask() }, "Reproduce the paper");
    this.cancel = element("button", { type: "button", hidden: true, click: () => board.cancel(this.task) }, "Cancel");
    this.progress = element("progress", { max: 1, hidden: true, "aria-label": "Progress of the report" });
    this.state = element("p", { class: "paper-state", role: "status" });
    this.link = element("a", { class: "paper-link", target: "_blank", rel: "noopener", hidden: true }, "Open the report in a new tab");
    this.root = element(
      "div",
      { class: "result-section result-scrolls paper-section", tabindex: "0", role: "group", "aria-label": "The paper, reproduced" },
      element("h3", {}, "The paper, reproduced"),
      element(
        "p",
        { class: "hint" },
        "Every figure and claim of the paper is computed anew with this simulation and these controllers, and compared. It takes a while; control goes on meanwhile.",
      ),
      element("div", { class: "form-row" }, this.start, this.cancel),
      this.progress,
      this.state,
      this.link,
    );
    board.addEventListener("change", () => this.#show());
  }

  async #ask() {
    this.problem = "";
    try {
      await this.board.ask({ kind: "paper" });
    } catch (refusal) {
      this.problem = refusal.message;
    }
    this.#show();
  }

  #show() {
    const task = (this.task = this.board.tasks.find(({ kind }) => kind === "paper") ?? null);
    const isActive = task !== null && TaskBoard.isActive(task);
    this.start.disabled = isActive;
    this.cancel.hidden = this.progress.hidden = !isActive;
    this.progress.value = task?.progress ?? 0;
    setText(this.state, this.problem || (task ? words(task) : ""));
    this.link.hidden = task?.state !== "done";
    if (task) this.link.href = reportAddress(task);
  }
}

function words({ state, words: doing, progress, reason, seconds }) {
  if (state === "queued") return "Waits for the tasks before it.";
  if (state === "running") return `${Math.round(100 * progress)} %${doing ? `, ${doing}` : ""}`;
  if (state === "done") return `Done in ${Math.round(seconds)} s.`;
  if (state === "cancelled") return "Cancelled.";
  return `The report was ${state === "refused" ? "refused" : "not made"}: ${reason}.`;
}
