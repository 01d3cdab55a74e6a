import { element } from "../element.js";
import { rest } from "../session/rest.js";
import { LinePanel } from "./panel.js";

/** Which ready scenario runs; choosing one loads it and starts again at t = 0. */
export class ScenarioPanel {
  #descriptions = new Map();

  constructor(layout, desk) {
    this.desk = desk;
    this.select = element("select", { "aria-label": "Scenario", change: () => this.#load() });
    const again = element(
      "button",
      {
        type: "button",
        class: "quiet",
        title: "Load this scenario again, as it was written",
        click: () => this.#load(),
      },
      "Reload",
    );
    this.root = new LinePanel(layout, element("div", { class: "line" }, this.select, again)).root;
    desk.session.addEventListener("hello", () => this.#fetch());
    this.#fetch();
  }

  echo() {
    const name = this.desk.document.value("name");
    if (!name) return;
    if (![...this.select.options].some((option) => option.value === name)) this.select.append(new Option(name, name));
    this.select.value = name;
    this.select.title = this.#descriptions.get(name) ?? this.desk.document.value("description") ?? "";
  }

  async #fetch() {
    try {
      const scenarios = await rest("GET", "/api/scenarios");
      const entries = scenarios.map((entry) => (typeof entry === "string" ? { name: entry } : entry));
      this.#descriptions = new Map(entries.map((entry) => [entry.name, entry.description]));
      this.select.replaceChildren(...entries.map((entry) => new Option(entry.title ?? entry.name, entry.name)));
      this.echo();
    } catch (refusal) {
      this.desk.session.note(refusal.message);
    }
  }

  async #load() {
    try {
      await this.desk.session.command("load_scenario", { name: this.select.value });
    } catch (refusal) {
      this.desk.session.note(refusal.message);
      this.echo();
    }
  }
}
