import { element, setText } from "../element.js";
import { rest } from "../session/rest.js";
import { addressOf } from "./samples.js";

const CHANNELS = [
  ["link_position", "the link’s path"],
  ["reference", "its reference"],
];
const LOADS = "The live session starts again at t = 0 with this recording’s scenario";

/** What a recording is good for in the live session: its motion as a reference, its scenario. */
export class UsePanel {
  /** @param {object} session @param {() => [number, number]} shown span, s */
  constructor(session, shown) {
    this.session = session;
    this.shown = shown;
    this.channel = element("select", { "aria-label": "Motion to follow" }, ...CHANNELS.map(([name, text]) => new Option(text, name)));
    this.reference = this.#button("Use as reference", "The live session then follows what is shown of this motion", () => this.#follow());
    this.scenario = this.#button("Load its scenario", LOADS, () => this.#load());
    this.words = element("p", { class: "form-hint", role: "status", hidden: true });
    this.root = element(
      "section",
      { class: "side-panel", "aria-label": "In the live session" },
      element("h2", {}, "In the live session"),
      element("div", { class: "form-row" }, element("span", { class: "form-name" }, "motion"), this.channel),
      element("div", { class: "form-row", "data-needs-control": true }, this.reference, this.scenario),
      this.words,
    );
  }

  open(facts) {
    const names = new Set(facts.channels.map(({ name }) => name));
    for (const option of this.channel.options) option.disabled = !names.has(option.value);
    this.facts = facts;
    this.scenario.disabled = !facts.scenario;
    this.scenario.title = facts.scenario ? LOADS : "It holds no scenario";
    this.#say("");
  }

  async #follow() {
    const [from_s, to_s] = this.shown();
    const query = { channel: this.channel.value, from_s, to_s };
    const replace = await rest("GET", addressOf(this.facts.id, "reference", query), undefined, 30_000);
    await this.session.command("set_reference", { replace });
    return "The live session follows it now.";
  }

  async #load() {
    await this.session.command("load_scenario", { scenario: this.facts.scenario });
    return "It runs live now, from t = 0.";
  }

  #button(text, title, act) {
    const button = element("button", { type: "button", title }, text);
    button.addEventListener("click", async () => {
      button.disabled = true;
      this.#say(await act().catch((refusal) => refusal.message));
      button.disabled = button === this.scenario && !this.facts.scenario;
    });
    return button;
  }

  #say(text) {
    setText(this.words, text);
    this.words.hidden = text === "";
  }
}
