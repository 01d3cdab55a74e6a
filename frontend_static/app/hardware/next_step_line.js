import { element, setText } from "../element.js";
import { STEPS, nextStep } from "./next_step.js";

const BUTTONS = { home: "Home", arm: "Arm", hold: "Hold", reset: "Reset", askControl: "Ask for control", takeControl: "Take control" };

/** The line at the top of the view: how far the operator is, what comes next, the limits at work, and one button. */
export class NextStepLine {
  /** @param {object} desk {session, operator, actions} */
  constructor({ session, operator, actions }) {
    Object.assign(this, { session, operator, actions });
    this.steps = STEPS.map(({ text }, i) => element("li", {}, element("span", { class: "step-mark", "aria-hidden": "true" }, i + 1), text));
    this.words = element("p", { class: "next-words", role: "status" });
    this.refused = element("p", { class: "next-refused", role: "status", hidden: true });
    this.limits = element("p", { class: "limits-now" });
    this.button = element("button", { type: "button", class: "start", hidden: true, click: () => this.#act() });
    this.root = element("div", { id: "next-step" }, element("ol", { "aria-label": "Steps" }, ...this.steps), this.words, this.refused, this.limits, this.button);
    session.addEventListener("snapshot", () => this.#show());
    operator.addEventListener("change", () => this.#show());
    actions.addEventListener("change", () => this.#show());
    this.#show();
  }

  #show() {
    const limits = this.session.snapshot?.limits.join("; ") ?? "";
    setText(this.limits, limits);
    this.limits.title = limits;
    const { at, tone, words, action, isPossible } = nextStep(this.session.snapshot ?? {}, this.operator, this.actions.underWay);
    const now = STEPS.findIndex(({ id }) => id === at);
    for (const [i, step] of this.steps.entries()) {
      step.dataset.step = i < now ? "done" : i === now ? "now" : "later";
      setText(step.firstElementChild, i < now ? "✓" : String(i + 1));
      if (i === now) step.setAttribute("aria-current", "step");
      else step.removeAttribute("aria-current");
    }
    this.root.dataset.tone = tone;
    setText(this.words, words);
    this.words.title = words;
    this.button.hidden = action === null;
    this.button.disabled = !isPossible;
    setText(this.button, BUTTONS[action] ?? "");
    if (action !== this.action) this.#refuse("");
    this.action = action;
  }

  async #act() {
    this.#refuse("");
    try {
      await this.actions[this.action]();
    } catch (refusal) {
      this.#refuse(refusal.message);
    }
  }

  #refuse(text) {
    setText(this.refused, text);
    this.refused.title = text;
    this.refused.hidden = text === "";
  }
}
