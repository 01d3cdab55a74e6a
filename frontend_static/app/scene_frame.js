import { element, setText } from "./element.js";

/** A 3D scene of the server in its frame; says so when it cannot be loaded. */
export class SceneFrame {
  #shownTheme = "";

  /** @param {HTMLElement} area @param {{address: string, title: string, problem: string}} words @param {object} theme */
  constructor(area, { address, title, problem }, theme) {
    this.address = address;
    this.problemWords = problem;
    this.theme = theme;
    this.problem = element("p", { class: "scene-problem", hidden: true });
    this.frame = element("iframe", { title, tabindex: "-1" });
    this.frame.addEventListener("load", () => this.#check());
    area.prepend(this.frame, this.problem);
    theme.addEventListener("change", () => this.#shownTheme && this.load());
  }

  /** Load the scene, unless it is there. */
  load() {
    const { inForce } = this.theme;
    if (this.#shownTheme === inForce && this.problem.hidden) return;
    this.#shownTheme = inForce;
    this.frame.src = `${this.address}?theme=${inForce}`;
  }

  /** A refused page is another type of document, a failed one cannot be looked into. */
  #check() {
    if (!this.frame.getAttribute("src")) return;
    let type = null;
    try {
      type = this.frame.contentDocument?.contentType ?? null;
    } catch {
      type = null;
    }
    const isScene = type === "text/html";
    if (isScene) this.#forwardKeys();
    this.problem.hidden = isScene;
    this.frame.hidden = !isScene;
    if (!isScene) setText(this.problem, this.problemWords);
  }

  /** Keys pressed in the frame, Esc above all, act on the page, also where the frame does not pass them on itself. */
  #forwardKeys() {
    this.frame.contentWindow.addEventListener(
      "keydown",
      (event) => dispatchEvent(new KeyboardEvent("keydown", event)),
      { capture: true },
    );
  }
}
