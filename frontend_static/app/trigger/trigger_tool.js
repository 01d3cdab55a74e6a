import { element, setText } from "../element.js";
import { inputText, readNumber } from "../quantity.js";

const EVENTS = [
  ["any", "any event"],
  ["limit", "a limit"],
  ["fault", "a fault"],
  ["tuning", "a tuning"],
  ["disturbance", "a disturbance"],
];
const EDGES = [
  ["rising", "rising"],
  ["falling", "falling"],
  ["either", "either way"],
];
const WORDS = { off: "Trigger", armed: "Trigger: armed", fired: "Trigger: fired", captured: "Trigger: captured" };
const NOT_LEVELS = new Set(["time", "tuning_id", "limits"]);

/** The trigger in the line above the charts: a button that says how it stands, and a form beneath it. */
export class TriggerTool {
  /** @param {HTMLElement} toolbar @param {import("./trigger.js").Trigger} trigger */
  constructor(toolbar, trigger) {
    this.trigger = trigger;
    this.button = element("button", {
      type: "button",
      class: "tool",
      id: "trigger",
      "aria-expanded": "false",
      "aria-controls": "trigger-form",
      click: () => this.#open(this.form.hidden),
    });
    this.source = choice("Fires at", [...EVENTS, ["level", "a level"]], () => this.#showSource());
    this.channel = choice("Channel", []);
    this.level = number("Level", 0);
    this.unit = element("span", { class: "row-unit" });
    this.edge = choice("Edge", EDGES);
    this.before = number("Seconds before", 2);
    this.after = number("Seconds after", 1);
    this.repeat = element("input", { type: "checkbox" });
    this.arm = element("button", { type: "submit" }, "Arm");
    this.disarm = element("button", { type: "button", click: () => this.#ask(trigger.disarm()) }, "Disarm");
    this.state = element("p", { class: "trigger-state", role: "status" });
    this.levelLine = element("div", { class: "line" }, this.channel, this.edge);
    this.valueLine = element("div", { class: "line" }, "through", this.level, this.unit);
    this.form = element(
      "form",
      { id: "trigger-form", class: "trigger-form", "aria-label": "Trigger", hidden: true },
      element("div", { class: "line" }, "fires at", this.source),
      this.levelLine,
      this.valueLine,
      element("div", { class: "line" }, "keeps", this.before, "s before,", this.after, "s after"),
      element("label", { class: "line" }, this.repeat, "again and again"),
      element("div", { class: "line" }, this.arm, this.disarm),
      this.state,
    );
    this.form.addEventListener("submit", (event) => (event.preventDefault(), this.#arm()));
    this.channel.addEventListener("change", () => this.#showUnit());
    toolbar.insertBefore(this.button, toolbar.querySelector(".follow"));
    toolbar.parentElement.append(this.form);
    document.addEventListener("pointerdown", ({ target }) => {
      if (!this.form.contains(target) && target !== this.button) this.#open(false);
    });
    trigger.session.addEventListener("hello", () => this.#showChannels());
    trigger.addEventListener("change", () => this.#show());
    this.#show();
    this.#showSource();
  }

  #open(isOpen) {
    this.form.hidden = !isOpen;
    this.button.setAttribute("aria-expanded", String(isOpen));
    if (isOpen) this.source.focus();
  }

  #arm() {
    const isLevel = this.source.value === "level";
    const level = { kind: "level", channel: this.channel.value, level: readNumber(this.level.value), edge: this.edge.value };
    const asked = {
      source: isLevel ? level : { kind: "event", event: this.source.value },
      before_s: readNumber(this.before.value),
      after_s: readNumber(this.after.value),
      repeat: this.repeat.checked,
    };
    const numbers = [asked.before_s, asked.after_s, ...(isLevel ? [level.level] : [])];
    if (numbers.some((value) => !Number.isFinite(value))) return this.#say("Every box needs a number.", true);
    return this.#ask(this.trigger.arm(asked));
  }

  async #ask(answer) {
    try {
      await answer;
      this.#show();
    } catch (refusal) {
      this.#say(refusal.message, true);
    }
  }

  #show() {
    const { now, session, isWaiting } = this.trigger;
    setText(this.button, WORDS[now.state]);
    this.button.title = now.state === "off" ? "Hold the picture at an event or a level" : now.sentence;
    this.button.setAttribute("aria-pressed", String(isWaiting));
    this.arm.disabled = !session.isConnected;
    setText(this.arm, isWaiting ? "Arm anew" : "Arm");
    this.disarm.disabled = !session.isConnected || now.state === "off";
    this.#say(now.state === "off" ? "" : now.sentence);
  }

  #say(text, isRefused = false) {
    setText(this.state, text);
    this.state.classList.toggle("is-warning", isRefused);
  }

  #showSource() {
    const isLevel = this.source.value === "level";
    this.levelLine.hidden = this.valueLine.hidden = !isLevel;
  }

  #showChannels() {
    const chosen = this.channel.value || "error";
    const known = [...this.trigger.session.channels.values()].filter(({ name }) => !NOT_LEVELS.has(name));
    this.channel.replaceChildren(...known.map(({ name, label }) => new Option(label, name, false, name === chosen)));
    this.#showUnit();
  }

  #showUnit() {
    setText(this.unit, this.trigger.session.channels.get(this.channel.value)?.unit ?? "");
  }
}

function choice(label, options, change = () => {}) {
  return element("select", { "aria-label": label, change }, ...options.map(([value, text]) => new Option(text, value)));
}

function number(label, value) {
  return element("input", {
    type: "text",
    inputmode: "decimal",
    autocomplete: "off",
    "aria-label": label,
    value: inputText(value),
  });
}
