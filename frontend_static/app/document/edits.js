import { valueAt, withValues } from "./scenario_document.js";

/** Which command changes which section of the document while it runs; all else asks for a restart. */
export const COMMANDS = {
  tuning: "tune",
  reference: "set_reference",
  stiffness_reference: "set_stiffness",
  disturbances: "set_disturbances",
};

/**
 * Changes made on this page: sent as commands, and remembered with their inverse for undo and redo.
 *
 * Changes with the same gesture (one drag of a slider) are undone together. Event `change` when the stacks change.
 */
export class Edits extends EventTarget {
  #done = [];
  #undone = [];

  constructor(session) {
    super();
    this.session = session;
    this.document = session.document;
  }

  /** Change single fields. @param {string} section "tuning", … @param {Object<string, any>} changes relative path to value */
  change(section, changes, gesture = Symbol("gesture")) {
    const takesKind = Object.keys(changes).some((path) => path.endsWith("kind"));
    const before = takesKind ? this.#whole(section) : { changes: this.#present(section, changes) };
    return this.#send(section, { changes }, before, gesture);
  }

  /** Load the scenario with other values at these paths of the document; it starts again at t = 0. */
  restart(changes) {
    const before = Object.keys(changes).map((path) => [path, valueAt(this.document.beginning, path)]);
    return this.#send("scenario", { changes }, { changes: Object.fromEntries(before) }, Symbol("restart"));
  }

  /** Replace a whole section. */
  replace(section, value, gesture = Symbol("gesture")) {
    return this.#send(section, { replace: value }, this.#whole(section), gesture);
  }

  /** Remember a change of a section that another command made, such as applying a preset. */
  remember(section, before, after) {
    this.#push({ section, before: { replace: before }, after: { replace: after }, gesture: Symbol("gesture") });
  }

  forget() {
    this.#done = [];
    this.#undone = [];
  }

  async undo() {
    const edit = this.#done.pop();
    if (!edit) return this.session.note("Nothing to undo on this page.", "info");
    await this.#step(edit, edit.before, this.#done, this.#undone);
  }

  async redo() {
    const edit = this.#undone.pop();
    if (!edit) return this.session.note("Nothing to redo on this page.", "info");
    await this.#step(edit, edit.after, this.#undone, this.#done);
  }

  async #step(edit, args, from, to) {
    try {
      await this.#command(edit.section, args);
      to.push({ ...edit, gesture: Symbol("closed") });
    } catch (refusal) {
      from.push(edit);
      this.session.note(refusal.message);
    }
  }

  async #send(section, after, before, gesture) {
    const result = await this.#command(section, after);
    this.#push({ section, before, after, gesture });
    return result;
  }

  async #command(section, args) {
    const isRestart = section === "scenario";
    const result = await (isRestart
      ? this.session.command("load_scenario", { scenario: withValues(this.document.beginning, args.changes) })
      : this.session.command(COMMANDS[section], args));
    this.document.applied(section, result.applied);
    return result;
  }

  #push(edit) {
    const last = this.#done.at(-1);
    if (last?.gesture === edit.gesture) last.after = edit.after;
    else this.#done.push(edit);
    this.#undone = [];
  }

  #whole(section) {
    return { replace: structuredClone(this.document.value(section)) };
  }

  #present(section, changes) {
    return Object.fromEntries(Object.keys(changes).map((path) => [path, this.document.value(`${section}.${path}`)]));
  }
}
