import { rest } from "../session/rest.js";

const POLL_MS = 250;
const RETRY_MS = 2000;
const ACTIVE = new Set(["queued", "running"]);

/**
 * The long tasks of the server, and the results that this page has fetched; a result stays while the page is open.
 *
 * Events: `change` (states, progress), `result` (detail: {task, asked, result}).
 */
export class TaskBoard extends EventTarget {
  #asked = new Map();
  #results = new Map();
  #timer = null;

  constructor() {
    super();
    this.tasks = [];
    this.problem = "";
  }

  static isActive(task) {
    return ACTIVE.has(task.state);
  }

  /** Look at the server's list now, and again while anything is under way. */
  async refresh() {
    clearTimeout(this.#timer);
    let wait = null;
    try {
      this.tasks = await rest("GET", "/api/tasks");
      this.problem = "";
      if (this.tasks.some(TaskBoard.isActive)) wait = POLL_MS;
    } catch (refusal) {
      this.problem = refusal.message;
      wait = RETRY_MS;
    }
    this.#timer = wait === null ? null : setTimeout(() => this.refresh(), wait);
    this.dispatchEvent(new Event("change"));
    for (const task of this.tasks) if (task.state === "done" && this.#asked.has(identity(task))) this.#fetchOnce(task);
  }

  /** Ask for a task. @param {object} body @param {object} about what to remember with it @param {string} address that starts it
   *  @throws {Refusal} */
  async ask(body, about = {}, address = "/api/tasks") {
    const task = await rest("POST", address, body);
    this.#asked.set(identity(task), { body, ...about });
    this.refresh();
    return task;
  }

  async cancel(task) {
    await rest("DELETE", `/api/tasks/${task.id}`).catch((refusal) => (this.problem = refusal.message));
    this.refresh();
  }

  /** What this page remembers of a task it asked for. */
  about(task) {
    return this.#asked.get(identity(task)) ?? null;
  }

  /** Show the result of a task that is done (again). */
  async open(task) {
    const result = this.#results.get(identity(task)) ?? (await this.#fetch(task));
    if (result) this.#tell(task, result);
  }

  async #fetchOnce(task) {
    if (this.#results.has(identity(task))) return;
    const result = await this.#fetch(task);
    if (result) this.#tell(task, result);
  }

  async #fetch(task) {
    this.#results.set(identity(task), null);
    try {
      const result = await rest("GET", `/api/tasks/${task.id}/result`, undefined, 30_000);
      this.#results.set(identity(task), result);
      return result;
    } catch (refusal) {
      this.#results.delete(identity(task));
      this.problem = refusal.message;
      this.dispatchEvent(new Event("change"));
      return null;
    }
  }

  #tell(task, result) {
    this.dispatchEvent(new CustomEvent("result", { detail: { task, asked: this.about(task), result } }));
  }
}

/** A restarted server counts its tasks anew. */
function identity({ id, asked_at }) {
  return `${id} ${asked_at}`;
}
