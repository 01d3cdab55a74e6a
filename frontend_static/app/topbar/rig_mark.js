import { element, setText } from "../element.js";

const WORDS = { emulated: "EMULATED", real: "REAL" };

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
    this.mark.dataset.kind = rig.kind;
    document.body.dataset.rig = rig.kind;
    setText(this.kind, WORDS[rig.kind] ?? rig.label);
    setText(this.name, WORDS[rig.kind] ? (rig.name ?? "") : "");
    this.name.hidden = this.name.textContent === "";
    this.mark.title = rig.kind === "real" ? `The real rig ${rig.name}: it moves` : rig.kind === "emulated" ? `The emulated rig ${rig.name}: nothing real moves` : rig.label;
  }
}
