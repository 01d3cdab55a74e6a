const ICONS = { auto: "◐", dark: "●", light: "○" };

/** Goes through automatic, dark and light. */
export class ThemeButton {
  constructor(theme) {
    this.theme = theme;
    this.button = document.getElementById("theme");
    this.button.addEventListener("click", () => theme.next());
    theme.addEventListener("change", () => this.#show());
    this.#show();
  }

  #show() {
    const { choice } = this.theme;
    this.button.textContent = ICONS[choice];
    this.button.setAttribute("aria-label", `Colours: ${choice}`);
    this.button.title = `Colours: ${choice === "auto" ? "as the system" : choice}`;
  }
}
