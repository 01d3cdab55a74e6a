/** A command that was not carried out; `problem` has the shape of RFC 9457 (docs/protocol.md, "REST"). */
export class Refusal extends Error {
  constructor(problem) {
    super(problem?.detail || problem?.title || "The server refused this without a reason.");
    this.problem = problem ?? {};
  }

  /** @returns {string} what is wrong with one field, in the fewest words the server gives */
  about(path) {
    const errors = this.problem.errors ?? [];
    const own = errors.find((error) => error.field === path || path.endsWith(`.${error.field}`));
    return own?.message ?? (errors.length === 1 ? errors[0].message : this.message);
  }
}

export const notConnected = () =>
  new Refusal({ title: "No connection", detail: "No connection to the server: nothing was changed." });
