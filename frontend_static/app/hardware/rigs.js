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

  /** Ask who answers, without touching anything. @returns {Promise<{ok: boolean, lines: object[]}>} @throws {Refusal} */
  check(name) {
    return rest("POST", `/api/rigs/${encodeURIComponent(name)}/check`, {}, CHECK_LIMIT_MS);
  }
}
