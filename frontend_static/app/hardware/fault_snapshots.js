import { element } from "../element.js";
import { RigPanel } from "./rig_panel.js";

/** What was recorded around each fault; a click opens it in the view Recordings. */
export class FaultSnapshots {
  /** @param {object} desk {pins, openRecording: (id, [from, to], at) => void} */
  constructor({ pins, openRecording }) {
    this.openRecording = openRecording;
    this.list = element("ul", { class: "snapshot-list" });
    this.empty = element("p", { class: "hint" }, "Two seconds before a fault and one after are kept here.");
    this.panel = new RigPanel("Recorded at faults", this.list, this.empty);
    this.root = this.panel.root;
    this.pins = pins;
    pins.addEventListener("change", () => this.#show());
    this.#show();
  }

  #show() {
    const found = this.pins.list.map(({ excerpt }) => excerpt).filter(({ kind }) => kind === "fault").reverse();
    this.empty.hidden = found.length > 0;
    const text = JSON.stringify(found.map(({ id, label, recording }) => [id, label, recording]));
    if (this.list.dataset.text === text) return;
    this.list.dataset.text = text;
    this.list.replaceChildren(...found.map((excerpt) => element("li", {}, this.#button(excerpt))));
  }

  #button({ label, recording, from_s, to_s, at_s, created_at }) {
    const when = new Date(created_at).toLocaleTimeString([], { hour12: false });
    return element(
      "button",
      { type: "button", class: "quiet", disabled: recording === null, title: recording === null ? "It was not recorded" : `${label}: open in Recordings`, click: () => this.openRecording(recording, [from_s, to_s], at_s) },
      element("time", { datetime: created_at }, when),
      element("span", { class: "log-text" }, label),
    );
  }
}
