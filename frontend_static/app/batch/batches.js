import { batchRoutes } from "./batch_routes.js";
import { isActive } from "./words.js";

const PAGE = 100;
const LOOK_AGAIN_MS = 1000;
const RETRY_MS = 4000;

/**
 * The server's batches, newest first, looked at again while one runs and somebody looks.
 *
 * Events: `list`, `problem`; `told` with the batch that the server answered with.
 */
export class Batches extends EventTarget {
  #resumed = new Set(); // until the server has answered
  #isShown = false;
  #timer = null;
  #asked = 0;

  constructor(session) {
    super();
    this.list = [];
    this.total = 0;
    this.problem = "";
    this.isLoaded = false;
    session.addEventListener("batches", () => this.#isShown && this.refresh());
    session.addEventListener("hello", () => this.#isShown && this.refresh());
  }

  get(id) {
    return this.list.find((batch) => batch.id === id) ?? null;
  }

  set isShown(isShown) {
    if (isShown === this.#isShown) return;
    this.#isShown = isShown;
    clearTimeout(this.#timer);
    if (isShown) this.refresh();
  }

  async refresh() {
    clearTimeout(this.#timer);
    const asked = (this.#asked += 1);
    let again = 0;
    try {
      const answer = await batchRoutes.list({ limit: PAGE });
      if (asked !== this.#asked) return;
      this.list = answer.batches;
      this.total = answer.total ?? this.list.length;
      this.isLoaded = true;
      if (this.list.some(isActive)) again = LOOK_AGAIN_MS;
      this.#say("");
      this.dispatchEvent(new Event("list"));
    } catch (refusal) {
      if (asked !== this.#asked) return;
      again = RETRY_MS;
      this.#say(refusal.message);
    }
    if (again && this.#isShown) this.#timer = setTimeout(() => this.refresh(), again);
  }

  /** @returns {Promise<object>} the batch that now waits or runs @throws {Refusal} */
  async start(document, key) {
    const batch = await batchRoutes.create(document, key);
    await this.refresh();
    return batch;
  }

  cancel(id) {
    return this.#change(() => batchRoutes.cancel(id));
  }

  /** Let it go on with the parts that are missing. @param {string} id @param {(problem: string) => void} [hear] says why it cannot */
  async resume(id, hear = (problem) => this.#say(problem)) {
    if (this.#resumed.has(id)) return;
    this.#resumed.add(id);
    await this.#change(() => batchRoutes.resume(id), hear);
    this.#resumed.delete(id);
  }

  remove(id) {
    return this.#change(() => batchRoutes.remove(id));
  }

  async #change(act, hear = (problem) => this.#say(problem)) {
    let problem = "";
    try {
      const told = await act();
      if (told?.id) this.dispatchEvent(new CustomEvent("told", { detail: told }));
    } catch (refusal) {
      problem = refusal.message;
    }
    await this.refresh();
    if (problem) hear(problem);
  }

  #say(problem) {
    this.problem = problem;
    this.dispatchEvent(new Event("problem"));
  }
}
