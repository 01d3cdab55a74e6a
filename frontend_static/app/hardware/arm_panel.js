import { element, setText } from "../element.js";
import { sentence } from "./next_step.js";
import { RigPanel, panelButton } from "./rig_panel.js";

const MOVING = new Set(["armed", "running"]);

/** Arm and Disarm, and every reason why arming would be refused. */
export class ArmPanel {
  /** @param {object} desk {session, operator, actions} */
  constructor({ session, operator, actions }) {
    Object.assign(this, { session, operator });
    this.arm = panelButton("Arm", () => this.panel.tell(actions.arm()), "Close the loops, holding where the rig is");
    this.disarm = panelButton("Disarm", () => this.panel.tell(actions.disarm()), "Come to rest, then drives off");
    this.reasons = element("ul", { class: "rig-reasons" });
    this.panel = new RigPanel("Arm", element("div", { class: "rig-row" }, this.arm, this.disarm), this.reasons);
    this.root = this.panel.root;
    session.addEventListener("snapshot", () => this.#show());
    operator.addEventListener("change", () => this.#show());
    this.#show();
  }

  #show() {
    const { operator, session } = this;
    const { isOnRig, rig, mayChange } = operator;
    const state = session.snapshot?.state;
    const isArmed = isOnRig && MOVING.has(state);
    const reasons = isOnRig && !isArmed ? (rig.cannot_arm ?? []) : [];
    this.arm.disabled = !isOnRig || !mayChange || state !== "ready" || reasons.length > 0;
    this.disarm.disabled = !session.isConnected || !isArmed; // as safe as STOP: needs no control
    setText(this.panel.aside, !isOnRig ? "" : isArmed ? "armed" : state === "stopping" ? "braking" : "drives off");
    this.panel.root.dataset.armed = String(isArmed);
    this.reasons.hidden = reasons.length === 0;
    const text = reasons.join("\n");
    if (this.reasons.dataset.text === text) return;
    this.reasons.dataset.text = text;
    this.reasons.replaceChildren(...reasons.map((reason) => element("li", {}, sentence(reason))));
  }
}
