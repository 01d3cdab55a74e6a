/** The colours of the style sheet, resolved for drawing on a canvas. */
export class Palette {
  #known = new Map();

  constructor(theme) {
    this.probe = document.createElement("span");
    this.probe.hidden = true;
    document.body.append(this.probe);
    theme.addEventListener("change", () => this.#known.clear());
  }

  /** @param {string} name of a CSS variable, without the dashes @returns {string} its colour in force */
  colour(name) {
    if (!this.#known.has(name)) {
      this.probe.style.color = `var(--${name})`;
      this.#known.set(name, getComputedStyle(this.probe).color);
    }
    return this.#known.get(name);
  }

  /** @param {string} name @param {number} alpha 0 to 1 @returns {string} the same colour, see-through */
  faint(name, alpha) {
    return this.colour(name).replace(/^rgb\((.*)\)$/, (_, parts) => `rgb(${parts.replaceAll(",", " ")} / ${alpha})`);
  }
}
