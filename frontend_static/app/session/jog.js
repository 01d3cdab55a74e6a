const RENEW_MS = 100;
const MOST_UNANSWERED = 3;
/** States in which a rig can be jogged. */
export const MOVABLE = new Set(["armed", "running"]);
const STILL = { link: 0, stiffness: 0 };

/**
 * A jog for as long as something is held: asked for at once, renewed while held, let go of once. Whatever could mean that
 * nobody looks or nobody hears ends it: another window, a hidden page, a lost connection, answers that do not come.
 * A refusal ends it too, but for one that says `wait`: then it begins as soon as it may, if it is still held.
 *
 * Event `change` when it begins, ends or goes another way, has to wait or need not wait any more.
 */
export class Jog extends EventTarget {
  #timer = null;
  #unanswered = 0;
  #isWaiting = false;
  #velocity = STILL;

  /** @param {import("./operator.js").Operator} operator */
  constructor(operator) {
    super();
    this.operator = operator;
    this.session = operator.session;
    this.problem = "";
    operator.addEventListener("silence", () => this.end());
    operator.addEventListener("change", () => operator.mayChange || this.end());
    this.session.addEventListener("snapshot", () => MOVABLE.has(this.session.snapshot.state) || this.end());
    addEventListener("blur", () => this.end());
  }

  get isHeld() {
    return this.#timer !== null;
  }

  /** What is asked for: link [rad/s], stiffness [N m/rad/s]. */
  get velocity() {
    return this.#velocity;
  }

  /** Move like this from now on, until `end`; 0, 0 ends. */
  hold(velocity) {
    if (velocity.link === 0 && velocity.stiffness === 0) return this.end();
    if (document.hidden || !this.operator.mayChange) return undefined;
    if (!this.isHeld) this.problem = "";
    this.#velocity = velocity;
    this.#timer ??= setInterval(() => this.#renew(), RENEW_MS);
    this.#renew();
    return this.dispatchEvent(new Event("change"));
  }

  /** Let go, once. */
  end() {
    if (!this.isHeld) return;
    clearInterval(this.#timer);
    this.#timer = null;
    this.#velocity = STILL;
    this.#wait("");
    if (this.session.isConnected) this.session.command("jog", STILL).catch(() => {}); // it runs out by itself
    this.dispatchEvent(new Event("change"));
  }

  async #renew() {
    if (this.#unanswered >= MOST_UNANSWERED) {
      return this.#giveUp("The server answers too late: the jog was let go.");
    }
    this.#unanswered += 1;
    try {
      await this.session.command("jog", this.#velocity);
      this.#wait("");
    } catch (refusal) {
      if (!refusal.problem?.wait) this.#giveUp(refusal.message);
      else if (this.isHeld) this.#wait(refusal.message);
    } finally {
      this.#unanswered -= 1;
    }
  }

  #giveUp(problem) {
    this.#wait("");
    this.problem = problem;
    this.end();
  }

  /** Say what this jog waits for, "" when it waits no more; another problem stays. */
  #wait(sentence) {
    if (!sentence && !this.#isWaiting) return;
    this.#isWaiting = sentence !== "";
    if (sentence === this.problem) return;
    this.problem = sentence;
    this.dispatchEvent(new Event("change"));
  }
}
