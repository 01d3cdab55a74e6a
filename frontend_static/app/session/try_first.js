import { Refusal } from "./refusal.js";

const GATHER_MS = 300;
const TRY_LIMIT_MS = 30_000;

/**
 * Changes of the tuning that are tried in a simulation before they reach the rig: gathered while a hand moves, sent to
 * `try_tuning`, and then applied or discarded as a whole.
 *
 * Event `change`.
 */
export class TryFirst extends EventTarget {
  #timer = null;
  #asked = 0;

  /** @param {import("./operator.js").Operator} operator */
  constructor(operator) {
    super();
    this.operator = operator;
    this.session = operator.session;
    this.isOn = false;
    this.#clear();
    operator.addEventListener("change", () => operator.isOnRig || this.discard());
  }

  /** Whether a change of the tuning is to be tried first. */
  get isWanted() {
    return this.isOn && this.operator.isOnRig;
  }

  switch(isOn) {
    this.isOn = isOn;
    if (isOn) this.#changed();
    else this.discard();
  }

  /** Gather a change. @returns {{applied: object, words: string}} what its row is told: nothing is applied yet */
  propose(changes) {
    this.changes = { ...this.changes, ...changes };
    this.result = null;
    this.problem = "";
    this.isBusy = true;
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#try(), GATHER_MS);
    this.#changed();
    return { applied: {}, words: "tried in simulation first" };
  }

  /** Send what was tried to the rig. @throws {Refusal} */
  async apply() {
    const { changes } = this;
    if (!changes) throw new Refusal({ detail: "There is nothing to apply." });
    const { applied } = await this.session.command("tune", { changes });
    this.session.document.applied("tuning", applied);
    this.discard();
  }

  discard() {
    clearTimeout(this.#timer);
    this.#asked += 1;
    this.#clear();
    this.#changed();
  }

  async #try() {
    const number = (this.#asked += 1);
    const { changes } = this;
    const answer = await this.session.command("try_tuning", { changes }, TRY_LIMIT_MS).then(
      (result) => ({ result, problem: "" }),
      (refusal) => ({ result: null, problem: refusal.message }),
    );
    if (number !== this.#asked) return;
    Object.assign(this, answer, { isBusy: false });
    this.#changed();
  }

  #clear() {
    this.changes = null; // {path: value}, null = none
    this.result = null;
    this.problem = "";
    this.isBusy = false;
  }

  #changed() {
    this.dispatchEvent(new Event("change"));
  }
}
