import { NumberBox } from "../analyse/number_box.js";
import { element, setText } from "../element.js";
import { briefly } from "../quantity.js";
import { RigPanel } from "./rig_panel.js";

/** Move the link to a position, at up to a speed; from armed only. */
export class GoToPanel {
  /** @param {object} desk {session, operator, actions, choices} */
  constructor({ session, operator, actions, choices }) {
    Object.assign(this, { session, operator, actions, choices });
    this.position = new NumberBox("Position to go to", 1, 4);
    this.speed = new NumberBox("Speed at most", 1, 3);
    this.position.root.value = "0";
    this.positionUnit = element("span", { class: "form-unit" });
    this.speedUnit = element("span", { class: "form-unit" });
    this.button = element("button", { type: "submit" }, "Go");
    this.hint = element("p", { class: "hint" });
    this.form = element(
      "form",
      { class: "go-to", novalidate: true },
      element("div", { class: "rig-row" }, this.position.root, this.positionUnit, element("span", { class: "go-within" }, "at up to"), this.speed.root, this.speedUnit, this.button),
    );
    this.form.addEventListener("submit", (event) => (event.preventDefault(), this.#go()));
    this.panel = new RigPanel("Go to", this.form, this.hint);
    this.root = this.panel.root;
    session.addEventListener("snapshot", () => this.#show());
    operator.addEventListener("change", () => this.#show());
    choices.addEventListener("change", () => this.#rescale());
    this.#rescale();
  }

  #go() {
    if (this.button.disabled) return undefined;
    try {
      return this.panel.tell(this.actions.goTo(this.position.read(), this.speed.read()));
    } catch (error) {
      return this.panel.say(error.message);
    }
  }

  /** Keep what was typed, in the unit that is shown now. */
  #rescale() {
    for (const [box, { factor }] of [[this.position, this.choices.linkAngle], [this.speed, this.choices.linkSpeed]]) {
      const typed = box.root.value.trim() === "" ? NaN : box.read();
      box.factor = factor;
      if (!Number.isNaN(typed)) box.set(typed);
    }
    setText(this.positionUnit, this.choices.linkAngle.unit);
    setText(this.speedUnit, this.choices.linkSpeed.unit);
    this.#show();
  }

  #show() {
    const { operator, session, choices } = this;
    const { limits } = operator.rig;
    const isPossible = operator.isOnRig && operator.mayChange && session.snapshot?.state === "armed";
    for (const control of [this.position.root, this.speed.root, this.button]) control.disabled = !isPossible;
    if (limits && this.speed.root.value === "") this.speed.set(limits.jog_speed / 2);
    const { factor, unit } = choices.linkAngle;
    setText(this.hint, limits ? `Between ${briefly(limits.link_low * factor)} and ${briefly(limits.link_high * factor)} ${unit}.` : "");
    this.hint.hidden = !limits;
  }
}
