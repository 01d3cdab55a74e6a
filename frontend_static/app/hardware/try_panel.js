import { element } from "../element.js";
import { RigPanel } from "./rig_panel.js";
import { TryResult } from "../parameters/try_result.js";

/** The switch that has every change of the tuning tried in simulation before it reaches the rig. */
export class TryPanel {
  /** @param {object} desk {session, operator, tryFirst} */
  constructor(desk) {
    const { tryFirst } = desk;
    const box = element("input", { type: "checkbox", role: "switch", change: () => tryFirst.switch(box.checked) });
    const label = element("label", { class: "rig-switch" }, box, "Simulate a changed tuning before it reaches the rig");
    this.panel = new RigPanel("Try first", label, new TryResult(desk).root);
    this.root = this.panel.root;
    tryFirst.addEventListener("change", () => (box.checked = tryFirst.isOn));
  }
}
