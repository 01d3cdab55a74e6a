import { element, setText } from "../element.js";
import { fixed } from "../quantity.js";
import { RigPanel, panelButton } from "./rig_panel.js";

const LATCHED = new Set(["stopped", "fault"]);
const FIRST_STOP = 100; // from here on, numbers are stops without a fault

/** Faults that latched, whether their cause still stands, and Reset. */
export class FaultPanel {
  /** @param {object} desk {session, operator, actions} */
  constructor({ session, operator, actions }) {
    Object.assign(this, { session, operator });
    this.list = element("ul", { class: "fault-list" });
    this.none = element("p", { class: "hint" }, "None.");
    this.reset = panelButton("Reset", () => this.panel.tell(actions.reset()), "Take back a stop or faults whose cause is gone; the drives stay off");
    this.panel = new RigPanel("Faults", this.list, this.none);
    this.panel.aside.after(this.reset);
    this.root = this.panel.root;
    session.addEventListener("snapshot", () => this.#show());
    operator.addEventListener("change", () => this.#show());
    this.#show();
  }

  #show() {
    const { operator, session } = this;
    const { rig, isOnRig, mayChange } = operator;
    const state = session.snapshot?.state;
    const faults = isOnRig ? (rig.faults ?? []) : [];
    const standing = faults.filter(({ stands }) => stands);
    this.reset.hidden = !isOnRig || !LATCHED.has(state);
    this.reset.disabled = !mayChange;
    this.reset.title = operator.why || "A drive that reports a fault is asked once to leave it; what stands is refused. The drives stay off";
    this.none.hidden = faults.length > 0;
    this.root.dataset.tone = faults.some(({ number }) => number < FIRST_STOP) ? "fault" : "";
    setText(this.panel.aside, standing.length ? `${standing.length} stand${standing.length === 1 ? "s" : ""}` : "");
    const text = JSON.stringify(faults);
    if (this.list.dataset.text === text) return;
    this.list.dataset.text = text;
    this.list.replaceChildren(...faults.map(faultLine));
  }
}

function faultLine({ number, sentence, at_s, stands }) {
  return element(
    "li",
    { class: "fault-line", "data-stands": String(stands), title: sentence },
    element("span", { class: "fault-number" }, String(number)),
    element("span", { class: "fault-sentence" }, sentence),
    element("span", { class: "fault-when" }, `${fixed(at_s, 2)} s`, element("br"), stands ? "stands" : "gone"),
  );
}
