import { element, setText } from "../element.js";
import { SliderScale } from "../parameters/slider_scale.js";
import { SliderStream } from "../parameters/slider_stream.js";
import { CommitBox } from "../parameters/commit_box.js";
import { fixed, inputText, readNumber } from "../quantity.js";
import { RigPanel } from "./rig_panel.js";

const LIVE = new Set(["armed", "running", "ready", "connected"]);

/** The stiffness asked for, live, within the rig's limits; its figure beside the title is what the rig has. */
export class StiffnessPanel {
  #isDragging = false;

  /** @param {object} desk {session, operator, actions} */
  constructor({ session, operator, actions }) {
    Object.assign(this, { session, operator, actions });
    this.slider = element("input", { type: "range", min: 0, max: SliderScale.positions, step: 1, "aria-label": "Stiffness asked for" });
    this.box = new CommitBox("Stiffness asked for, N·m/rad", (text) => this.#typed(text), { inputmode: "decimal", class: "number" });
    this.stream = new SliderStream((value) => this.panel.tell(actions.setStiffness(value)));
    this.panel = new RigPanel("Stiffness", element("div", { class: "rig-row" }, this.slider, this.box.root, element("span", { class: "form-unit" }, "N·m/rad")));
    this.root = this.panel.root;
    this.slider.addEventListener("pointerdown", () => (this.#isDragging = true));
    for (const type of ["pointerup", "pointercancel", "change", "blur"]) this.slider.addEventListener(type, () => this.#settle());
    this.slider.addEventListener("input", () => this.#moved());
    session.addEventListener("snapshot", () => this.#show());
    session.document.addEventListener("change", () => this.#show());
    operator.addEventListener("change", () => this.#show());
    this.#show();
  }

  #moved() {
    const value = this.scale.value(Number(this.slider.value));
    this.slider.style.setProperty("--share", this.slider.value / SliderScale.positions);
    this.box.show(inputText(value));
    this.stream.move(value);
  }

  #typed(text) {
    const value = readNumber(text);
    if (Number.isFinite(value)) this.stream.move(value);
    else this.panel.say(`“${text.trim()}” is not a number.`);
    this.#show();
  }

  #settle() {
    this.#isDragging = false;
    this.#show();
  }

  #show() {
    const { operator, session } = this;
    const { limits } = operator.rig;
    const isPossible = operator.isOnRig && operator.mayChange && LIVE.has(session.snapshot?.state);
    this.slider.disabled = this.box.root.disabled = !isPossible;
    const [low, high] = limits ? [limits.stiffness_low, limits.stiffness_high] : [20, 1000];
    if (this.scale?.low !== low || this.scale?.high !== high)
      this.scale = new SliderScale({ typical: [low, high], isLogarithmic: true, step: 1, low, high });
    const now = session.snapshot?.stiffness;
    setText(this.panel.aside, operator.isOnRig && typeof now === "number" ? `now ${fixed(now, now < 100 ? 1 : 0)} N·m/rad` : "");
    const asked = this.actions.stiffness;
    if (asked === undefined || this.#isDragging || this.stream.isWaiting) return;
    this.slider.value = this.scale.position(asked);
    this.slider.style.setProperty("--share", this.slider.value / SliderScale.positions);
    this.slider.setAttribute("aria-valuetext", `${inputText(asked)} N·m/rad`);
    this.box.show(inputText(Number(asked.toPrecision(4))));
  }
}
