import { element } from "../element.js";

let groups = 0;

/**
 * A row of alternatives of which one holds, made of radio buttons. It shows what it is told by `show`; a click only asks.
 */
export class Segmented {
  /** @param {string} label what is chosen @param {{value: any, text: string, title?: string}[]} options
   *  @param {(value: any) => void} choose called with what was clicked */
  constructor(label, options, choose) {
    const name = `choice-${(groups += 1)}`;
    this.shown = undefined;
    this.options = options.map(({ value, text, title }) => {
      const input = element("input", { type: "radio", name, value: String(value) });
      input.addEventListener("change", () => {
        this.show(this.shown);
        choose(value);
      });
      return { value, input, label: element("label", { title }, input, element("span", {}, text)) };
    });
    this.root = element("div", { class: "segmented", role: "radiogroup", "aria-label": label }, ...this.options.map((option) => option.label));
  }

  show(value) {
    this.shown = value;
    for (const option of this.options) option.input.checked = option.value === value;
  }
}
