import { element, setText } from "./element.js";
import { fixed } from "./quantity.js";

const CAPTION_PERIOD_MS = 200;

/** The 3D scene in its frame, with a caption from the telemetry; says so when the scene cannot be loaded. */
export class Scene {
  #shownTheme = "";

  constructor(session, theme) {
    this.session = session;
    this.theme = theme;
    this.area = document.getElementById("scene");
    this.caption = document.getElementById("scene-caption");
    this.problem = element("p", { class: "scene-problem", hidden: true });
    this.frame = element("iframe", { title: "3D view of the actuator", tabindex: "-1" });
    this.frame.addEventListener("load", () => this.#check());
    this.area.prepend(this.frame, this.problem);
    theme.addEventListener("change", () => this.#load());
    session.addEventListener("connection", () => session.isConnected && this.#load());
    setInterval(() => this.#describe(), CAPTION_PERIOD_MS);
  }

  #load() {
    const { inForce } = this.theme;
    if (this.#shownTheme === inForce && this.problem.hidden) return;
    this.#shownTheme = inForce;
    this.frame.src = `/scene/?theme=${inForce}`;
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
    if (!isScene)
      setText(
        this.problem,
        "The 3D scene could not be loaded. Plots and control work without it; it is tried again at the next connection.",
      );
  }

  /** Keys pressed in the frame, Esc above all, act on the page, also where the frame does not pass them on itself. */
  #forwardKeys() {
    this.frame.contentWindow.addEventListener(
      "keydown",
      (event) => dispatchEvent(new KeyboardEvent("keydown", event)),
      { capture: true },
    );
  }

  #describe() {
    const { store } = this.session;
    const stiffness = store.latest("stiffness");
    const degrees = (store.latest("deflection") * 180) / Math.PI;
    setText(this.caption, `k ${fixed(stiffness, stiffness < 100 ? 1 : 0)} N·m/rad · deflection ${fixed(degrees, 1)}°`);
  }
}
