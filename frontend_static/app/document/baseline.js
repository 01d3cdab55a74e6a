import { rest } from "../session/rest.js";
import { valueAt } from "./scenario_document.js";

/**
 * What the present values are compared with: the preset in use for the tuning, else the scenario as it was loaded.
 */
export class Baseline extends EventTarget {
  #loaded = null;
  #asked = null;

  constructor(document) {
    super();
    this.document = document;
    document.addEventListener("change", () => this.#fetchLoaded());
    this.#fetchLoaded();
  }

  /** @returns {string} name of what the tuning is compared with, "" if there is nothing */
  get name() {
    return this.document.preset?.name ?? this.#loaded?.name ?? "";
  }

  /** @returns {any} the baseline's value at a path of the document, undefined if it has none */
  value(path) {
    const preset = this.document.preset;
    return preset?.tuning && path.startsWith("tuning.") ? valueAt(preset, path) : valueAt(this.#loaded, path);
  }

  /** @returns {{path: string, from: any, to: any}[]} every field of the tuning that differs */
  tuningChanges() {
    const now = this.document.value("tuning");
    const then = this.document.preset?.tuning ?? this.#loaded?.tuning;
    return now && then ? differences(then, now, "tuning") : [];
  }

  async #fetchLoaded() {
    const name = this.document.scenario?.name;
    if (!name || name === this.#asked) return;
    this.#asked = name;
    this.#loaded = await readyScenario(name).catch(() => null);
    this.dispatchEvent(new Event("change"));
  }
}

/** @returns {Promise<object|null>} a ready scenario, null if that of a rig or of a file is meant */
async function readyScenario(name) {
  const ready = await rest("GET", "/api/scenarios");
  return ready.some((each) => (each.name ?? each) === name) ? rest("GET", `/api/scenarios/${encodeURIComponent(name)}`) : null;
}

function differences(from, to, path) {
  if (from?.kind !== to?.kind) return [{ path: `${path}.kind`, from: from?.kind, to: to?.kind }];
  return Object.keys(to).flatMap((name) => {
    const [a, b] = [from[name], to[name]];
    if (b !== null && typeof b === "object") return differences(a, b, `${path}.${name}`);
    return Object.is(a, b) ? [] : [{ path: `${path}.${name}`, from: a, to: b }];
  });
}
