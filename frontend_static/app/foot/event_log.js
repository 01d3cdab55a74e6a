import { element, setText } from "../element.js";

const LINES = 200;
const MACHINES = new Set(["server", "session", "rig"]);

/** Who did what and when, newest on top; warnings and faults are also announced. */
export class EventLog {
  constructor(session) {
    this.session = session;
    this.list = document.getElementById("event-log");
    this.alert = document.getElementById("alert");
    session.addEventListener("hello", () => (this.list.replaceChildren(), this.#add(session.events)));
    session.addEventListener("log", ({ detail }) => this.#add(detail));
  }

  #add(events) {
    this.list.prepend(...events.map((event) => this.#line(event)).reverse());
    while (this.list.childElementCount > LINES) this.list.lastElementChild.remove();
    const serious = events.findLast((event) => event.severity !== "info");
    if (serious && events.length < 10) setText(this.alert, serious.text);
  }

  #line({ wall_time, text, by, severity }) {
    const when = new Date(wall_time);
    const who = by && by === this.session.you ? "you" : by;
    return element(
      "li",
      { class: `log-${severity}`, title: `${when.toLocaleString()}  ${text}${who ? `  (${who})` : ""}` },
      element("time", { datetime: wall_time }, when.toLocaleTimeString([], { hour12: false })),
      element("span", { class: "log-text" }, text),
      who && !MACHINES.has(who) ? element("span", { class: "log-who" }, who) : null,
    );
  }
}
