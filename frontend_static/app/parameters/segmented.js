import { element, setText } from "../element.js";

const MOVES = { ArrowLeft: -1, ArrowUp: -1, ArrowRight: 1, ArrowDown: 1 };

/**
 * A row of alternatives of which one holds. It shows what it is told by `show`; a click only asks. Arrow keys move the
 * focus and Enter or Space chooses, so that nothing switches on a live rig by passing over it.
 */
export class Segmented {
  /** @param {string} label what is chosen @param {{value: any, text: string, title?: string}[]} options
   *  @param {(value: any) => void} choose called with what was clicked @param {number} [columns] more than fit beside each
   *  other stand in lines of so many */
  constructor(label, options, choose, columns) {
    this.shown = undefined;
    this.options = options.map(({ value, text, title }) => ({
      value,
      button: element(
        "button",
        { type: "button", role: "radio", "data-value": String(value), title, click: () => this.#ask(value, choose) },
        text,
      ),
    }));
    this.root = element(
      "div",
      {
        class: columns ? "segmented is-grid" : "segmented",
        role: "radiogroup",
        "aria-label": label,
        keydown: (event) => this.#move(event),
      },
      ...this.options.map((option) => option.button),
    );
    if (columns) this.root.style.setProperty("--columns", columns);
    this.show(undefined);
  }

  /** Write something else on the button of one alternative. */
  label(value, text) {
    setText(this.options.find((option) => option.value === value).button, text);
  }

  show(value) {
    this.shown = value;
    const reachable = this.options.find((option) => option.value === value) ?? this.options[0];
    for (const option of this.options) {
      option.button.setAttribute("aria-checked", String(option.value === value));
      option.button.tabIndex = option === reachable ? 0 : -1;
    }
  }

  #ask(value, choose) {
    if (value !== this.shown) choose(value);
  }

  #move(event) {
    const step = MOVES[event.key];
    if (!step) return;
    event.preventDefault();
    const at = this.options.findIndex((option) => option.button === document.activeElement);
    this.options[(at + step + this.options.length) % this.options.length].button.focus();
  }
}
