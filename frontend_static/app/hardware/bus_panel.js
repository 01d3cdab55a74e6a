import { element, setText } from "../element.js";
import { fixed } from "../quantity.js";
import { RigPanel } from "./rig_panel.js";

const LINES = ["cycle", "lateness", "missed cycles", "late answers", "round trip"];

/** How well the loop and the bus keep their time. */
export class BusPanel {
  /** @param {object} desk {session, operator} */
  constructor({ session, operator }) {
    Object.assign(this, { session, operator });
    this.values = new Map(LINES.map((name) => [name, element("dd", {})]));
    this.panel = new RigPanel("Loop", element("dl", { class: "bus-list" }, ...LINES.flatMap((name) => [element("dt", {}, name), this.values.get(name)])));
    this.root = this.panel.root;
    session.addEventListener("snapshot", () => this.#show());
  }

  #show() {
    const { loop } = this.session.snapshot;
    const { rig, isOnRig } = this.operator;
    const bus = isOnRig ? rig.bus : null;
    const late = loop.lateness_us;
    this.#tell("cycle", `${fixed(isOnRig ? (rig.rate_hz ?? loop.rate_hz) : loop.rate_hz, 0)} Hz`);
    this.#tell("lateness", late ? `${fixed(late.p99, 0)} / ${fixed(late.worst, 0)} µs` : "–", false, "p99 / worst");
    this.#tell("missed cycles", bus ? String(bus.missed_cycles) : "–", bus?.missed_cycles > 0);
    this.#tell("late answers", bus ? String(bus.late_answers) : "–", bus?.late_answers > 0, bus ? `in ${bus.cycles} cycles` : "");
    this.#tell("round trip", bus ? `${fixed(bus.round_trip_us, 0)} µs` : "–", false, "from SYNC to the last answer");
    setText(this.panel.aside, loop.scheduling ?? "");
    this.panel.aside.classList.toggle("is-warning", isOnRig && loop.scheduling === "best effort");
  }

  #tell(name, text, isWarning = false, title = "") {
    const value = this.values.get(name);
    setText(value, text);
    value.title = title;
    value.classList.toggle("is-warning", isWarning);
  }
}
