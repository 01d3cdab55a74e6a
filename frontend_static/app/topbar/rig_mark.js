import { element, setText } from "../element.js";

const WORDS = { emulated: "EMULATED", real: "REAL", connecting: "connecting" };
const TITLES = {
  emulated: (name) => `The emulated rig ${name}: nothing real moves`,
  real: (name) => `The real rig ${name}: it moves`,
  connecting: (name) => `${name} is being connected: its drives are off`,
};

/** Which rig moves when this page says so: simulated, emulated or real. A line along the whole top says the same. */
export class RigMark {
  constructor(session) {
    this.session = session;
    this.mark = document.getElementById("rig");
    this.kind = element("span", { class: "rig-kind" });
    this.name = element("span", { class: "rig-name" });
    this.mark.replaceChildren(this.kind, this.name);
    session.addEventListener("snapshot", () => this.#show());
  }

  #show() {
    const { rig } = this.session.snapshot;
    const kind = rig.name && !rig.connected ? "connecting" : rig.kind; // which kind it is, the rig has still to say
    this.mark.dataset.kind = kind;
    document.body.dataset.rig = kind;
    setText(this.kind, WORDS[kind] ?? rig.label);
    setText(this.name, WORDS[kind] ? (rig.name ?? "") : "");
    this.name.hidden = this.name.textContent === "";
    this.mark.title = TITLES[kind]?.(rig.name) ?? rig.label;
  }
}
