/** @returns {any} what lies at a dotted path, or undefined */
export function valueAt(root, path) {
  return path === "" ? root : path.split(".").reduce((part, name) => part?.[name], root);
}

/** @returns {object} a copy of a document with other values at dotted paths */
export function withValues(root, values) {
  const copy = structuredClone(root);
  for (const [path, value] of Object.entries(values)) {
    const names = path.split(".");
    const leaf = names.pop();
    valueAt(copy, names.join("."))[leaf] = value;
  }
  return copy;
}

/**
 * The scenario that the session runs, as the server last said it. Nothing here is a wish of the page.
 *
 * Event `change`; detail: {own: true} if it answers a change made on this page.
 */
export class ScenarioDocument extends EventTarget {
  constructor() {
    super();
    this.scenario = null;
    this.beginning = null;
    this.preset = null;
    this.by = "";
  }

  value(path) {
    return valueAt(this.scenario, path);
  }

  /** @param {{scenario: object, beginning: object|null, preset: object|null, by: string}} message the server's `document` */
  accept({ scenario, beginning, preset, by }) {
    this.scenario = scenario;
    this.beginning = beginning ?? scenario; // as it stands at t = 0, before its sequence changes it
    this.preset = preset ?? null;
    this.by = by ?? "";
    this.#changed(false);
  }

  /** Take over what a command's result says was applied: {path relative to the section: value}. */
  applied(section, values = {}) {
    if (!this.scenario) return;
    const scenario = structuredClone(this.scenario);
    for (const [path, value] of Object.entries(values)) {
      const names = `${section}.${path}`.split(".");
      const leaf = names.pop();
      const part = valueAt(scenario, names.join("."));
      if (part && leaf in part && leaf !== "kind") part[leaf] = value;
    }
    this.scenario = scenario;
    this.#changed(true);
  }

  #changed(own) {
    this.dispatchEvent(new CustomEvent("change", { detail: { own } }));
  }
}
