import { element, setText } from "../element.js";
import { Segmented } from "../parameters/segmented.js";
import { RigPanel } from "./rig_panel.js";

/** In which units this view shows its numbers and plots. */
export class DisplayPanel {
  /** @param {object} desk {operator, choices} */
  constructor({ operator, choices }) {
    Object.assign(this, { operator, choices });
    const row = (name, options) => new Segmented(`Shown ${name}`, options, (value) => choices.choose(name, value));
    this.rows = {
      angle: row("angle", [{ value: "rad", text: "rad" }, { value: "deg", text: "degrees" }]),
      side: row("side", [{ value: "gear", text: "gear side" }, { value: "motor", text: "motor side" }]),
      torque: row("torque", [{ value: "torque", text: "torque" }, { value: "current", text: "current" }]),
    };
    this.hint = element("p", { class: "hint" });
    this.panel = new RigPanel("Shown as", ...Object.values(this.rows).map(({ root }) => root), this.hint);
    this.root = this.panel.root;
    choices.addEventListener("change", () => this.#show());
    operator.addEventListener("change", () => this.#show());
    this.#show();
  }

  #show() {
    const { rig, isOnRig } = this.operator;
    for (const [name, row] of Object.entries(this.rows)) row.show(this.choices[name]);
    for (const { value, button } of this.rows.side.options) button.disabled = value === "motor" && !rig.gear_ratio;
    for (const { value, button } of this.rows.torque.options) button.disabled = value === "current" && !rig.torque_constant;
    setText(this.hint, isOnRig && !rig.torque_constant ? "Its file names no torque constant: torques only." : "");
    this.hint.hidden = this.hint.textContent === "";
  }
}
