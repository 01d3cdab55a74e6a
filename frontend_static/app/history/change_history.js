const KEPT = 200;

/**
 * The server's history of changes, one for all pages: what was changed, what can be undone, redone or returned to.
 *
 * Event `change`.
 */
export class ChangeHistory extends EventTarget {
  #entries = new Map();

  /** @param {import("../session/operator.js").Operator} operator */
  constructor(operator) {
    super();
    const { session } = operator;
    this.operator = operator;
    this.session = session;
    this.canUndo = this.canRedo = false;
    session.connection.addEventListener("message", ({ detail }) => this.#take(detail));
    operator.addEventListener("change", () => this.dispatchEvent(new Event("change")));
  }

  /** @returns {object[]} the entries as docs/protocol.md has them, oldest first */
  get entries() {
    return [...this.#entries.values()];
  }

  undo() {
    return this.#ask("undo");
  }

  redo() {
    return this.#ask("redo");
  }

  returnTo(number) {
    return this.#ask("return_to", { number });
  }

  savePoint(name) {
    return this.#ask("save_point", name ? { name } : {});
  }

  #take(message) {
    if (message.type === "hello") this.#entries = new Map();
    if (message.type !== "history" && message.type !== "hello") return;
    for (const entry of message.entries ?? message.history ?? []) this.#entries.set(entry.number, entry);
    for (const number of this.#entries.keys()) if (this.#entries.size > KEPT) this.#entries.delete(number);
    this.canUndo = message.can_undo === true;
    this.canRedo = message.can_redo === true;
    this.dispatchEvent(new Event("change"));
  }

  /** What is refused is a line of the log: there is no row that it belongs to. */
  async #ask(command, args) {
    try {
      await this.session.command(command, args);
    } catch (refusal) {
      this.session.note(refusal.message, refusal.problem?.status === 409 ? "info" : "warning");
    }
  }
}
