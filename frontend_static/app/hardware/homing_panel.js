import { element, setText } from "../element.js";
import { fixed } from "../quantity.js";
import { RigPanel, panelButton } from "./rig_panel.js";

const FROM = new Set(["connected", "ready"]);

/** Whether the stiffness axis knows where it is, and the button that finds out. */
export class HomingPanel {
  /** @param {object} desk {session, operator, actions} */
  constructor({ session, operator, actions }) {
    Object.assign(this, { session, operator });
    this.button = panelButton("Home", () => this.panel.tell(actions.home()), "The stiffness motor goes slowly to both of its end stops");
    this.words = element("p", { class: "rig-words" });
    this.panel = new RigPanel("Homing", element("div", { class: "rig-row" }, this.words, this.button));
    this.root = this.panel.root;
    session.addEventListener("snapshot", () => this.#show());
    operator.addEventListener("change", () => this.#show());
    this.#show();
  }

  #show() {
    const { operator, session } = this;
    const { isOnRig, rig } = operator;
    const state = session.snapshot?.state;
    this.button.disabled = !isOnRig || !operator.mayChange || !FROM.has(state);
    setText(this.button, rig.homed ? "Home again" : "Home");
    setText(this.panel.aside, !isOnRig ? "" : state === "homing" ? "homing…" : rig.homed ? "homed" : "not homed");
    setText(this.words, this.#describe(isOnRig, rig, state));
    if (state === "homing") this.panel.say("");
  }

  #describe(isOnRig, rig, state) {
    if (!isOnRig) return "Once a rig is connected.";
    if (state === "homing") return "Looking for both end stops.";
    if (rig.homed) return rig.span_found === null || rig.span_found === undefined ? "Both end stops found." : `Span of the end stops ${fixed(rig.span_found, 2)} rad.`;
    return "The stiffness is not known yet.";
  }
}
