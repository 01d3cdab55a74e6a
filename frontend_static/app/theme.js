/**
 * Dark, light, or as the system has it. The choice is remembered; saved_theme.js applies it before the first paint.
 *
 * Event `change` when the colours in force change.
 */
const KEY = "vssea.theme";
const ORDER = ["auto", "dark", "light"];

export class Theme extends EventTarget {
  #system = matchMedia("(prefers-color-scheme: dark)");

  constructor() {
    super();
    const saved = localStorage.getItem(KEY);
    this.choice = ORDER.includes(saved) ? saved : "auto";
    this.#system.addEventListener("change", () => this.choice === "auto" && this.dispatchEvent(new Event("change")));
  }

  /** @returns {"dark"|"light"} the colours in force */
  get inForce() {
    if (this.choice !== "auto") return this.choice;
    return this.#system.matches ? "dark" : "light";
  }

  next() {
    this.choice = ORDER[(ORDER.indexOf(this.choice) + 1) % ORDER.length];
    localStorage.setItem(KEY, this.choice);
    if (this.choice === "auto") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = this.choice;
    this.dispatchEvent(new Event("change"));
  }
}
