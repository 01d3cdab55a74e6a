import { element, setText } from "../element.js";

/**
 * One sentence beneath the top bar of every view but Hardware, while a rig is connected and this page may not change it.
 * What `data-needs-control` marks is out of reach for so long.
 */
export class ControlStrip {
  /** @param {import("../session/operator.js").Operator} operator @param {import("./views.js").Views} views */
  constructor(operator, views) {
    this.operator = operator;
    this.views = views;
    this.words = element("span", {});
    this.button = element("button", { type: "button", click: () => this.#act() });
    this.root = document.getElementById("control-strip");
    this.root.append(this.words, this.button);
    operator.addEventListener("change", () => this.#show());
    views.addEventListener("change", () => this.#show());
    this.#show();
  }

  #show() {
    const { operator, views } = this;
    const { control, session } = operator;
    const isLocked = session.isConnected && !operator.mayChange;
    document.body.dataset.control = isLocked ? "locked" : "free";
    for (const each of document.querySelectorAll("[data-needs-control]")) each.inert = isLocked;
    this.root.hidden = !isLocked || views.shown === "hardware";
    const hasAsked = (control.asking ?? []).includes(session.you);
    setText(this.words, hasAsked ? `You have asked for control; ${control.operator} sees it.` : operator.why);
    setText(this.button, control.operator ? "Ask for control" : "Take control");
    this.button.hidden = hasAsked;
  }

  async #act() {
    const { operator } = this;
    try {
      await (operator.control.operator ? operator.ask() : operator.take());
    } catch (refusal) {
      setText(this.words, refusal.message);
    }
  }
}
