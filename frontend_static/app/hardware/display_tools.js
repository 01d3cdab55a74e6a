import { element } from "../element.js";

const CHOICES = [
  { name: "angle", label: "Angles in", options: [["rad", "rad"], ["deg", "deg"]] },
  { name: "side", label: "Side of the motor", options: [["gear", "gear side"], ["motor", "motor side"]] },
  { name: "torque", label: "Torque or current", options: [["torque", "torque"], ["current", "current"]] },
];

/** In which units the view shows its numbers and plots: three choices in the line above the plots. */
export class DisplayTools {
  /** @param {object} desk {operator, choices} */
  constructor({ operator, choices }) {
    Object.assign(this, { operator, choices });
    this.selects = CHOICES.map(({ name, label, options }) => {
      const select = element("select", { "aria-label": label, title: label, change: () => choices.choose(name, select.value) });
      select.append(...options.map(([value, text]) => new Option(text, value)));
      return { name, select };
    });
    this.root = element("span", { class: "display-tools" }, element("span", { class: "display-word" }, "shown in"), ...this.selects.map(({ select }) => select));
    for (const source of [choices, operator]) source.addEventListener("change", () => this.#show());
    this.#show();
  }

  /** What the rig's file does not give cannot be chosen. */
  #show() {
    const { rig } = this.operator;
    const isKnown = { motor: Boolean(rig.gear_ratio), current: Boolean(rig.torque_constant) };
    for (const { name, select } of this.selects) {
      for (const option of select.options) option.disabled = isKnown[option.value] === false;
      select.value = this.choices[name];
    }
  }
}
