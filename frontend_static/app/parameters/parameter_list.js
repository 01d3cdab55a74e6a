import { element } from "../element.js";
import { PANELS } from "../layout.js";
import { DisturbancePanel } from "./disturbance_panel.js";
import { FieldHint } from "./field_hint.js";
import { GroupedPanel } from "./grouped_panel.js";
import { PartPanel } from "./part_panel.js";
import { PresetPanel } from "./preset_panel.js";
import { ScenarioPanel } from "./scenario_panel.js";
import { SequencePanel } from "./sequence_panel.js";

const SPECIAL = {
  scenario: ScenarioPanel,
  preset: PresetPanel,
  disturbance: DisturbancePanel,
  sequence: SequencePanel,
  grouped: GroupedPanel,
};

/** The scrolling column of parameter panels, in the order of layout.js; disabled as a whole without a connection. */
export class ParameterList {
  constructor(root, desk) {
    this.session = desk.session;
    const complete = { ...desk, document: desk.session.document, hint: new FieldHint() };
    this.panels = PANELS.map((layout) => new (SPECIAL[layout.is] ?? PartPanel)(layout, complete));
    this.fieldset = element(
      "fieldset",
      { class: "parameter-list", disabled: true },
      element("legend", { class: "unseen" }, "Parameters"),
    );
    this.fieldset.append(...this.panels.map((panel) => panel.root));
    root.replaceChildren(this.fieldset);
    complete.document.addEventListener("change", ({ detail }) => this.#echo(detail));
    complete.baseline.addEventListener("change", () => this.#echo({ own: false }));
    this.session.addEventListener("connection", () => this.#enable());
    this.#enable();
    this.#echo({ own: false });
  }

  get presets() {
    return this.panels.find((panel) => panel instanceof PresetPanel);
  }

  #enable() {
    this.fieldset.disabled = !this.session.isConnected;
  }

  #echo(change) {
    for (const panel of this.panels) panel.echo(change);
  }
}
