/** @returns {any} what lies at a dotted path, or undefined */
export function valueAt(root, path) {
  return path.split(".").reduce((part, name) => part?.[name], root);
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
    this.preset = null;
    this.by = "";
  }

  value(path) {
    return valueAt(this.scenario, path);
  }

  /** @param {{scenario: object, preset: object|null, by: string}} message the server's `document` */
  accept({ scenario, preset, by }) {
    this.scenario = scenario;
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
