import { element, setText } from "../element.js";
import { fixed, decimalsFor } from "../quantity.js";

const POSITIONS = 100;
const BEGIN = 50; // half of what is allowed, at each opening of the page

/** How fast a jog is: a share of the rig's greatest jog speed. */
export class SpeedSlider {
  constructor(label) {
    this.greatest = 0;
    this.shown = { unit: "", factor: 1 };
    this.slider = element("input", { type: "range", min: 5, max: POSITIONS, step: 5, value: BEGIN, "aria-label": label });
    this.figure = element("span", { class: "speed-figure" });
    this.unit = element("span", { class: "form-unit" });
    this.root = element("div", { class: "speed-row" }, element("span", { class: "speed-name" }, label), this.slider, this.figure, this.unit);
    this.slider.addEventListener("input", () => this.#show());
    this.#show();
  }

  /** @returns {number} the speed, SI */
  get speed() {
    return (this.greatest * Number(this.slider.value)) / POSITIONS;
  }

  /** @param {number} greatest SI @param {{unit: string, factor: number}} shown */
  scale(greatest, shown) {
    this.greatest = greatest ?? 0;
    this.shown = shown;
    this.#show();
  }

  #show() {
    const { factor, unit } = this.shown;
    this.slider.style.setProperty("--share", (this.slider.value - 5) / (POSITIONS - 5));
    setText(this.figure, this.greatest ? fixed(this.speed * factor, decimalsFor(this.greatest * factor)) : "–");
    setText(this.unit, unit);
    this.slider.setAttribute("aria-valuetext", `${this.figure.textContent} ${unit}`);
  }
}
