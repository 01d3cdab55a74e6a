import { rest } from "../session/rest.js";

const CHECK_LIMIT_MS = 60_000;

/** The rigs that the server knows. Event `change`. */
export class Rigs extends EventTarget {
  constructor() {
    super();
    this.list = null; // not yet known
    this.problem = "";
  }

  get(name) {
    return this.list?.find((rig) => rig.name === name) ?? null;
  }

  async refresh() {
    try {
      const { rigs } = await rest("GET", "/api/rigs");
      this.list = rigs;
      this.problem = "";
    } catch (refusal) {
      this.problem = refusal.message;
    }
    this.dispatchEvent(new Event("change"));
  }

  /** Keep a rig's file. @throws {Refusal} */
  async keep(name, text) {
    await rest("PUT", `/api/rigs/${encodeURIComponent(name)}`, text, undefined, { "content-type": "application/toml" });
    await this.refresh();
  }

  /** @returns {Promise<string>} the text of a rig's file @throws {Refusal} */
  async text(name) {
    return (await rest("GET", `/api/rigs/${encodeURIComponent(name)}`)).text;
  }

  /** Forget a rig. @throws {Refusal} */
  async remove(name) {
    await rest("DELETE", `/api/rigs/${encodeURIComponent(name)}`);
    await this.refresh();
  }

  /** Ask who answers, without touching anything. @returns {Promise<{ok: boolean, lines: object[]}>} @throws {Refusal} */
  check(name) {
    return rest("POST", `/api/rigs/${encodeURIComponent(name)}/check`, {}, CHECK_LIMIT_MS);
  }
}
