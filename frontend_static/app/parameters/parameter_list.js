import { element } from "../element.js";
import { PANELS } from "../layout.js";
import { DisturbancePanel } from "./disturbance_panel.js";
import { FieldHint } from "./field_hint.js";
import { GroupedPanel } from "./grouped_panel.js";
import { PartPanel } from "./part_panel.js";
import { PresetPanel } from "./preset_panel.js";
import { ScenarioPanel } from "./scenario_panel.js";
import { SequencePanel } from "./sequence_panel.js";
import { TryResult } from "./try_result.js";

const SPECIAL = {
  scenario: ScenarioPanel,
  preset: PresetPanel,
  disturbance: DisturbancePanel,
  sequence: SequencePanel,
  grouped: GroupedPanel,
};

const RESTARTS = new Set(["scenario", "sequence", "rig"]);

/**
 * The scrolling column of parameter panels, in the order of layout.js; disabled as a whole where this page may change nothing.
 * Of a rig, what would start the run again is not there.
 */
export class ParameterList {
  constructor(root, desk) {
    this.root = root;
    this.session = desk.session;
    this.operator = desk.operator;
    const complete = { ...desk, document: desk.session.document, hint: new FieldHint() };
    this.panels = PANELS.map((layout) => new (SPECIAL[layout.is] ?? PartPanel)(layout, complete));
    this.fieldset = element(
      "fieldset",
      { class: "parameter-list", disabled: true },
      element("legend", { class: "unseen" }, "Parameters"),
    );
    this.fieldset.append(...this.panels.map((panel) => panel.root));
    root.replaceChildren(new TryResult(desk).root, this.fieldset);
    complete.document.addEventListener("change", ({ detail }) => this.#echo(detail));
    complete.baseline.addEventListener("change", () => this.#echo({ own: false }));
    this.operator.addEventListener("change", () => this.#enable());
    this.#enable();
    this.#echo({ own: false });
  }

  get presets() {
    return this.panels.find((panel) => panel instanceof PresetPanel);
  }

  #enable() {
    this.fieldset.disabled = !this.operator.mayChange;
    this.root.tabIndex = this.fieldset.disabled ? 0 : -1; // with nothing to focus in it, the column itself is scrolled by keys
    for (const [i, { id }] of PANELS.entries()) if (RESTARTS.has(id)) this.panels[i].root.hidden = this.operator.isOnRig;
  }

  #echo(change) {
    for (const panel of this.panels) panel.echo(change);
  }
}
