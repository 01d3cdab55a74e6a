import { ParameterSchema } from "../document/parameter_schema.js";
import { element, setText } from "../element.js";
import { rest } from "../session/rest.js";
import { CalibrationPanel } from "./calibration_panel.js";
import { ComparePanel } from "./compare_panel.js";
import { DetailHead } from "./detail_head.js";
import { ValueTable } from "./value_table.js";
import { VersionTable } from "./version_table.js";

/** An actuator: its values, edited as a draft until they are saved as a new version; its calibration; what loading it changes. */
export class ActuatorDetail {
  #draft = null;
  #base = null;

  constructor(library, session) {
    this.library = library;
    this.head = new DetailHead(library);
    this.values = new ValueTable();
    this.calibration = new CalibrationPanel();
    this.compare = new ComparePanel(
      library,
      (version) => rest("POST", `/api/actuators/${encodeURIComponent(library.chosen.name)}/apply`, { version }),
      { title: "Difference", isChoice: false, applyText: () => "Load this plant (starts again at t = 0)" },
    );
    this.versions = new VersionTable(library, this.head, (version, against) => this.compare.compare(version, against));
    this.words = element("span", { class: "hint" });
    this.saveButton = element("button", { type: "button", class: "start", click: () => this.#save() });
    this.drop = element("button", { type: "button", class: "quiet", click: () => this.#take(library.chosen) }, "Drop them");
    this.bar = element("div", { class: "draft-bar", role: "status", hidden: true }, this.words, this.drop, this.saveButton);
    this.root = element(
      "div",
      { class: "detail" },
      this.head.root,
      this.bar,
      this.compare.root,
      this.values.root,
      this.calibration.root,
      this.versions.root,
    );
    for (const part of [this.values, this.calibration]) part.addEventListener("change", () => this.#changed());
    this.calibration.addEventListener("values", () => this.values.show(this.#draft, this.schema));
  }

  /** A draft stays while somebody else saves: it is then refused as stale, and its changes are not lost. */
  async show(found) {
    this.head.show(found);
    this.compare.show(found);
    this.versions.show(found);
    const isDraft = this.#base?.name === found.name && !this.bar.hidden;
    if (!isDraft) await this.#take(found);
  }

  look() {
    this.compare.refresh();
  }

  async #take(found) {
    this.#base = found;
    this.#draft = structuredClone(found.content);
    this.bar.hidden = true;
    try {
      this.schema ??= new ParameterSchema((await rest("GET", "/api/schema")).scenario);
      if (this.#base !== found) return;
      this.values.show(this.#draft, this.schema);
      this.calibration.show(this.#draft, { rows: [], fit: null });
      const report = await this.library.calibration(found.name, found.version);
      if (this.#base === found) this.calibration.show(this.#draft, report);
    } catch (refusal) {
      this.head.say(refusal.message);
    }
  }

  #changed() {
    const isSame = JSON.stringify(this.#draft) === JSON.stringify(this.#base.content);
    this.bar.hidden = isSame;
    setText(this.words, "Changes that are not saved yet.");
    setText(this.saveButton, `Save as version ${this.library.chosen.versions.length + 1}`);
  }

  async #save() {
    const { name, etag } = this.#base;
    const { actuator, provenance, calibration } = this.#draft;
    const change = async (known) => {
      await this.library.save(name, { actuator, provenance, calibration }, known);
      await this.#take(this.library.chosen);
    };
    await this.head.attempt(change, etag);
  }
}
