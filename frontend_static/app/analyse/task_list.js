import { element, setText } from "../element.js";
import { compact } from "../quantity.js";
import { TaskBoard } from "./task_board.js";

const WORDS = {
  queued: "waits",
  running: "running",
  done: "done",
  refused: "refused",
  failed: "failed",
  cancelled: "cancelled",
};

/** The list of long tasks: how far each is, why it ended, cancel and show. */
export class TaskList {
  #lines = new Map();

  /** @param {TaskBoard} board @param {(task: object) => string|null} report address of what a task wrote, if it is a report
   *  @param {(task: object) => boolean} canShow whether its result can be shown here */
  constructor(board, report, canShow) {
    this.board = board;
    this.report = report;
    this.canShow = canShow;
    this.list = element("ol", { class: "task-list" });
    this.problem = element("p", { class: "form-problem", role: "status", hidden: true });
    this.empty = element("p", { class: "hint" }, "None yet. Maps, searches and the paper’s report are listed here.");
    this.root = element("section", { class: "side-panel", "aria-label": "Tasks" }, element("h2", {}, "Tasks"), this.problem, this.list, this.empty);
    board.addEventListener("change", () => this.#show());
  }

  #show() {
    const { tasks, problem } = this.board;
    setText(this.problem, problem);
    this.problem.hidden = !problem;
    this.empty.hidden = tasks.length > 0;
    const keys = tasks.map((task) => `${task.id} ${task.asked_at}`);
    for (const [key, line] of this.#lines)
      if (!keys.includes(key)) {
        line.root.remove();
        this.#lines.delete(key);
      }
    tasks.forEach((task, i) => {
      if (!this.#lines.has(keys[i])) this.#lines.set(keys[i], new TaskLine(this.board, this.report, this.canShow));
      const line = this.#lines.get(keys[i]);
      line.show(task);
      if (this.list.children[i] !== line.root) this.list.insertBefore(line.root, this.list.children[i] ?? null);
    });
  }
}

/** One task; its parts stay the same elements, so that focus is kept while it goes on. */
class TaskLine {
  constructor(board, report, canShow) {
    this.board = board;
    this.report = report;
    this.canShow = canShow;
    this.title = element("span", { class: "task-title" });
    this.state = element("span", { class: "task-state" });
    this.progress = element("progress", { max: 1, "aria-label": "Progress" });
    this.reason = element("p", { class: "task-reason", hidden: true });
    this.cancel = element("button", { type: "button", class: "quiet", click: () => board.cancel(this.task) }, "Cancel");
    this.open = element("button", { type: "button", class: "quiet", click: () => board.open(this.task) }, "Show");
    this.link = element("a", { class: "task-link", target: "_blank", rel: "noopener", hidden: true }, "Open");
    this.root = element(
      "li",
      { class: "task" },
      element("div", { class: "task-line" }, this.title, this.state, this.cancel, this.open, this.link),
      this.progress,
      this.reason,
    );
  }

  show(task) {
    this.task = task;
    const about = this.board.about(task)?.words;
    const isActive = TaskBoard.isActive(task);
    setText(this.title, about ? `${task.title}: ${about}` : task.title);
    this.title.title = this.title.textContent;
    this.root.dataset.state = task.state;
    const seconds = task.seconds === null ? "" : `, ${compact(task.seconds)} s`;
    const percent = task.state === "running" ? ` ${Math.round(100 * task.progress)} %` : "";
    setText(this.state, `${WORDS[task.state] ?? task.state}${percent}${task.state === "done" ? seconds : ""}`);
    this.progress.hidden = !isActive;
    this.progress.value = task.progress;
    this.progress.title = task.words;
    setText(this.reason, task.reason ?? (task.state === "running" ? task.words : ""));
    this.reason.hidden = !this.reason.textContent;
    this.cancel.hidden = !isActive;
    const report = task.state === "done" ? this.report(task) : null;
    this.open.hidden = task.state !== "done" || report !== null || !this.canShow(task);
    this.link.hidden = report === null;
    if (report) this.link.href = report;
  }
}
