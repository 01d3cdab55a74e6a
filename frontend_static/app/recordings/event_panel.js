import { element } from "../element.js";
import { fixed } from "../quantity.js";

/** What happened in the recording; a click goes there. */
export class EventPanel {
  /** @param {(time: number) => void} go */
  constructor(go) {
    this.go = go;
    this.list = element("ol", { class: "recorded-events" });
    this.empty = element("p", { class: "hint" }, "Nothing happened in it: no change, no limit, no fault.");
    this.root = element("section", { class: "side-panel", "aria-label": "Events" }, element("h2", {}, "Events"), this.list, this.empty);
  }

  show({ events }) {
    const lines = events.filter(({ time_s }) => time_s !== null);
    this.empty.hidden = lines.length > 0;
    this.list.replaceChildren(...lines.map((event) => this.#line(event)));
  }

  #line({ time_s, text, by, severity }) {
    return element(
      "li",
      { class: `log-${severity}` },
      element(
        "button",
        { type: "button", class: "quiet", title: `${text}${by ? ` (${by})` : ""}: go there`, click: () => this.go(time_s) },
        element("time", {}, `${fixed(time_s, 2)} s`),
        element("span", { class: "log-text" }, text),
      ),
    );
  }
}
