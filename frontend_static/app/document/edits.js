import { withValues } from "./scenario_document.js";

/** Which command changes which section of the document while it runs; all else asks for a restart. */
export const COMMANDS = {
  tuning: "tune",
  reference: "set_reference",
  stiffness_reference: "set_stiffness",
  disturbances: "set_disturbances",
};

/** Changes made on this page, sent as commands. The server remembers them: see ChangeHistory. */
export class Edits {
  /** @param {import("../session/live_session.js").LiveSession} session @param {import("../session/try_first.js").TryFirst} tryFirst */
  constructor(session, tryFirst) {
    this.session = session;
    this.document = session.document;
    this.tryFirst = tryFirst;
  }

  /** Change single fields. @param {string} section "tuning", … @param {Object<string, any>} changes relative path to value */
  async change(section, changes) {
    if (section === "tuning" && this.tryFirst.isWanted) return this.tryFirst.propose(changes);
    return this.#command(section, { changes });
  }

  /** Replace a whole section. */
  replace(section, value) {
    return this.#command(section, { replace: value });
  }

  /** Load the scenario with other values at these paths of the document; it starts again at t = 0. */
  restart(changes) {
    return this.session.command("load_scenario", { scenario: withValues(this.document.beginning, changes) });
  }

  async #command(section, args) {
    const result = await this.session.command(COMMANDS[section], args);
    this.document.applied(section, result.applied);
    return result;
  }
}
