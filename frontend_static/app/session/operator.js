/** Who may move the rig. */

const RENEW_MS = 100;
const MOST_UNANSWERED = 3;
const SIMULATED = { kind: "simulated", label: "simulated rig", connected: false, name: null };
const NOT_NEEDED = { needed: false, operator: null, asking: [], expires_in_s: null };

/**
 * The page's share of the lease: who is in control, and the renewals for as long as this page is. A page that is hidden,
 * left or frozen is silent at once, and so is one whose renewals are not answered: the rig then stops by itself.
 *
 * Events: `change` when who is in control, or what is connected, is another; `silence` when the page must say no more.
 */
export class Operator extends EventTarget {
  #known = "";
  #timer = null;
  #unanswered = 0;
  #wasOperating = false;

  /** @param {import("./live_session.js").LiveSession} session */
  constructor(session) {
    super();
    this.session = session;
    for (const type of ["snapshot", "connection"]) session.addEventListener(type, () => this.#look());
    document.addEventListener("visibilitychange", () => (document.hidden ? this.#silence() : this.#resume()));
    document.addEventListener("freeze", () => this.#silence());
    addEventListener("pagehide", () => this.#silence());
    addEventListener("pageshow", () => this.#resume());
  }

  get rig() {
    return this.session.snapshot?.rig ?? SIMULATED;
  }

  /** Whether a rig is connected. */
  get isOnRig() {
    return this.rig.connected === true;
  }

  get control() {
    return this.session.snapshot?.control ?? NOT_NEEDED;
  }

  /** Whether this page is in control. */
  get isYou() {
    return this.control.operator !== null && this.control.operator === this.session.you;
  }

  /** Whether this page may change what runs: always in a simulation, on a rig only in control. */
  get mayChange() {
    return this.session.isConnected && (!this.control.needed || this.isYou);
  }

  /** @returns {string} why this page may not change anything, "" if it may */
  get why() {
    if (!this.session.isConnected) return "No connection to the server.";
    if (this.mayChange) return "";
    const { operator } = this.control;
    if (operator) return `${capital(operator)} is in control: ask for control to change anything.`;
    return "Nobody is in control: take control to change anything.";
  }

  async take() {
    await this.session.command("take_control");
    this.begin();
  }

  /** Renew from now on: a command has just given control to this page, and the snapshot that says so is still to come. */
  begin() {
    if (this.#timer !== null || document.hidden || !this.session.isConnected) return;
    this.#timer = setInterval(() => this.#renew(), RENEW_MS);
    this.#renew();
  }

  ask() {
    return this.session.command("ask_control");
  }

  release() {
    return this.session.command("release_control");
  }

  handTo(page) {
    return this.session.command("hand_control", { to: page });
  }

  #look() {
    const { isYou, control, rig, session } = this;
    const isOperating = isYou && session.isConnected && rig.name !== null; // without a rig, control is let go of
    if (isOperating && !this.#wasOperating) this.#resume();
    if (!isOperating) this.#end();
    this.#wasOperating = isOperating;
    const now = JSON.stringify([session.isConnected, session.you, control.needed, control.operator, control.asking, rig.kind, rig.name, rig.connected]);
    if (now === this.#known) return;
    this.#known = now;
    this.dispatchEvent(new Event("change"));
  }

  #resume() {
    if (this.isYou && this.rig.name !== null) this.begin();
  }

  #silence() {
    this.#end();
    this.dispatchEvent(new Event("silence"));
  }

  #end() {
    clearInterval(this.#timer);
    this.#timer = null;
  }

  async #renew() {
    if (this.#unanswered >= MOST_UNANSWERED) return; // late renewals would only pretend that someone is here
    this.#unanswered += 1;
    try {
      await this.session.command("renew_control");
    } catch (refusal) {
      if (refusal.problem?.status === 403) this.#end();
    } finally {
      this.#unanswered -= 1;
    }
  }
}

const capital = (text) => text.charAt(0).toUpperCase() + text.slice(1);
