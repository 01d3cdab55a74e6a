const RENEW_MS = 100;
const MOST_UNANSWERED = 3;
/** States in which a rig can be jogged. */
export const MOVABLE = new Set(["armed", "running"]);
const STILL = { link: 0, stiffness: 0 };

/**
 * A jog for as long as something is held: asked for at once, renewed while held, let go of once. Whatever could mean that
 * nobody looks or nobody hears ends it: another window, a hidden page, a lost connection, answers that do not come.
 *
 * Event `change` when it begins, ends or goes another way.
 */
export class Jog extends EventTarget {
  #timer = null;
  #unanswered = 0;
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
    if (this.session.isConnected) this.session.command("jog", STILL).catch(() => {}); // it runs out by itself
    this.dispatchEvent(new Event("change"));
  }

  async #renew() {
    if (this.#unanswered >= MOST_UNANSWERED) {
      this.problem = "The server answers too late: the jog was let go.";
      return this.end();
    }
    this.#unanswered += 1;
    try {
      await this.session.command("jog", this.#velocity);
    } catch (refusal) {
      this.problem = refusal.message;
      this.end();
    } finally {
      this.#unanswered -= 1;
    }
  }
}
