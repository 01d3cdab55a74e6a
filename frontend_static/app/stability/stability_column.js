import { commandedStiffness } from "../document/commanded_stiffness.js";
import { element } from "../element.js";
import { MarginPanel } from "./margin_panel.js";
import { MeaningPanel } from "./meaning_panel.js";
import { PolePanel } from "./pole_panel.js";
import { StabilityHead } from "./stability_head.js";
import { TruePlantPanel } from "./true_plant_panel.js";

/**
 * Margins beside the tuning, as the server computes them after each change. Until the answer to the newest change has come,
 * the old figures stay where they are, a little dimmer. The sentence stands in `root`; `body` is for the caller to place.
 */
export class StabilityColumn {
  constructor(root, session) {
    this.session = session;
    this.head = new StabilityHead(root);
    this.panels = [new MarginPanel(), new TruePlantPanel(), new PolePanel(session.document), new MeaningPanel()];
    this.body = element(
      "div",
      { id: "stability-body" },
      ...this.panels.map((panel) => panel.root),
    );
    root.append(this.head.root);
    session.addEventListener("margins", () => this.#show());
    session.document.addEventListener("change", () => this.#age());
    this.#show();
  }

  #show() {
    const { margins } = this.session;
    this.head.show(margins);
    this.body.hidden = !margins?.available;
    if (margins?.available) for (const panel of this.panels) panel.show(margins);
    this.#age();
  }

  #age() {
    const { margins, tuningId, document } = this.session;
    const isOld =
      margins?.available && (tuningId > margins.tuning_id || commandedStiffness(document) !== margins.stiffness);
    this.body.classList.toggle("is-old", Boolean(isOld));
  }
}
