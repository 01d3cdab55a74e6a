import { rest } from "../session/rest.js";

const SETTLE_MS = 250;
const TIME_LIMIT_MS = 35_000;

/**
 * The analysis of one loop and of the same loop at further stiffnesses, asked anew when the tuning or the subject changes.
 * One request is under way at a time; the newest question is the one that is answered.
 *
 * Event `change`; then `report`, `overlays`, `problem`, `isOld` and `isBusy` say what there is.
 */
export class LoopAnalysis extends EventTarget {
  #wanted = false;
  #timer = null;

  constructor(session, subject) {
    super();
    this.subject = subject;
    this.report = null;
    this.overlays = [];
    this.problem = "";
    this.isOld = true;
    this.isBusy = false;
    this.follows = true;
    this.isShown = false;
    session.addEventListener("margins", () => this.#age());
    subject.addEventListener("change", () => this.#age());
  }

  /** Whether changes of the tuning are followed at once. */
  follow(follows) {
    this.follows = follows;
    if (follows && this.isOld) this.ask();
    this.#tell();
  }

  /** Whether anyone looks. */
  show(isShown) {
    this.isShown = isShown;
    if (isShown && this.isOld && (this.follows || !this.report)) this.ask();
  }

  ask() {
    clearTimeout(this.#timer);
    this.#wanted = true;
    if (!this.isBusy) this.#answer();
  }

  #age() {
    this.isOld = true;
    clearTimeout(this.#timer);
    if (this.isShown && this.follows) this.#timer = setTimeout(() => this.ask(), SETTLE_MS);
    this.#tell();
  }

  async #answer() {
    this.isBusy = true;
    while (this.#wanted) {
      this.#wanted = false;
      this.isOld = false;
      this.#tell();
      await this.#fetch();
    }
    this.isBusy = false;
    this.#tell();
  }

  async #fetch() {
    const { request, plant } = this.subject;
    try {
      this.report = await rest("POST", "/api/analysis", request, TIME_LIMIT_MS);
      this.problem = "";
      this.#tell();
      const overlays = [];
      for (const stiffness of [...this.subject.overlays].sort((a, b) => a - b)) {
        if (this.#wanted) return;
        overlays.push(await rest("POST", "/api/analysis", { plant, stiffness }, TIME_LIMIT_MS));
      }
      this.overlays = overlays;
    } catch (refusal) {
      this.report = null;
      this.overlays = [];
      this.problem = refusal.message;
    }
  }

  #tell() {
    this.dispatchEvent(new Event("change"));
  }
}
