import { arrange, element, setText } from "../element.js";

/** Who is in control of the rig, with what can be done about it in a small menu. Absent where control is not needed. */
export class ControlMenu {
  /** @param {import("../session/operator.js").Operator} operator */
  constructor(operator) {
    this.operator = operator;
    this.session = operator.session;
    this.button = document.getElementById("control");
    this.pages = document.getElementById("pages");
    this.menu = document.getElementById("control-menu");
    this.words = element("p", {});
    this.note = element("p", { class: "rig-note", role: "status", hidden: true });
    this.buttons = new Map();
    this.button.addEventListener("click", () => this.#open(this.menu.hidden));
    document.addEventListener("pointerdown", ({ target }) => this.menu.contains(target) || this.button.contains(target) || this.#open(false));
    operator.addEventListener("change", () => this.#show());
    this.#show();
  }

  #show() {
    const { operator } = this;
    const { control, isYou, session } = operator;
    const isShown = control.needed && session.isConnected;
    this.button.hidden = !isShown;
    this.pages.hidden = isShown;
    if (!isShown) return this.#open(false);
    const asking = control.asking ?? [];
    const isAsked = isYou && asking.length > 0;
    this.button.dataset.who = isAsked ? "asked" : isYou ? "you" : control.operator ? "other" : "nobody";
    setText(this.button, isAsked ? `${asking[0]} asks for control` : isYou ? "You are in control" : control.operator ? `${control.operator} is in control` : "Nobody is in control");
    setText(this.words, this.#sentence(control, isYou, asking));
    arrange(this.menu, [this.words, ...this.#choices(control, isYou, asking), this.note]);
    return undefined;
  }

  #sentence({ operator }, isYou, asking) {
    const { name } = this.operator.rig;
    if (isYou && asking.length) return `${asking.join(" and ")} ${asking.length === 1 ? "asks" : "ask"} for control of ${name}.`;
    if (isYou) return `You are in control of ${name}. Hidden or closed, this page loses it and the rig stops.`;
    if (!operator) return `Nobody is in control of ${name}.`;
    if (asking.includes(this.session.you)) return `You have asked; ${operator} sees it.`;
    return `${operator} is in control of ${name}. STOP works from every page.`;
  }

  #choices({ operator }, isYou, asking) {
    const made = this.operator;
    if (isYou) return [...asking.map((page) => this.#choice(`Hand over to ${page}`, () => made.handTo(page))), this.#choice("Release control", () => made.release())];
    if (!operator) return [this.#choice("Take control", () => made.take())];
    return asking.includes(this.session.you) ? [] : [this.#choice("Ask for control", () => made.ask())];
  }

  /** Buttons are kept, so that one under the pointer or with focus stays. */
  #choice(text, act) {
    if (!this.buttons.has(text)) this.buttons.set(text, element("button", { type: "button", click: () => this.#do(act) }, text));
    return this.buttons.get(text);
  }

  async #do(act) {
    setText(this.note, "");
    await act().then(
      () => this.#open(false),
      (refusal) => setText(this.note, refusal.message),
    );
    this.note.hidden = this.note.textContent === "";
  }

  #open(isOpen) {
    if (this.menu.hidden === !isOpen) return;
    this.menu.hidden = !isOpen;
    this.button.setAttribute("aria-expanded", String(isOpen));
    if (isOpen) this.#place();
    if (isOpen) this.menu.querySelector("button")?.focus();
  }

  #place() {
    const { left, right } = this.button.getBoundingClientRect();
    this.menu.style.left = `${Math.max(8, Math.min(left, innerWidth - this.menu.offsetWidth - 8))}px`;
    this.menu.style.minWidth = `${right - left}px`;
  }
}
