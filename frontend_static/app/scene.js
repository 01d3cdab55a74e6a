import { setText } from "./element.js";
import { fixed } from "./quantity.js";
import { SceneFrame } from "./scene_frame.js";

const CAPTION_PERIOD_MS = 200;
const DEGREES = 180 / Math.PI;
const WORDS = {
  address: "/scene/",
  title: "3D view of the actuator",
  problem: "The 3D scene could not be loaded. Plots and control work without it; it is tried again at the next connection.",
};

/** The 3D scene of the session, with a caption from the telemetry. */
export class Scene {
  constructor(session, theme) {
    this.session = session;
    this.caption = document.getElementById("scene-caption");
    this.frame = new SceneFrame(document.getElementById("scene"), WORDS, theme);
    session.addEventListener("connection", () => session.isConnected && this.frame.load());
    setInterval(() => this.#describe(), CAPTION_PERIOD_MS);
  }

  #describe() {
    const { store } = this.session;
    setText(this.caption, sceneCaption(store.latest("stiffness"), store.latest("deflection")));
  }
}

/** @returns {string} stiffness [N m/rad] and deflection [rad] in words */
export function sceneCaption(stiffness, deflection) {
  return `k ${fixed(stiffness, stiffness < 100 ? 1 : 0)} N·m/rad · deflection ${fixed(deflection * DEGREES, 1)}°`;
}
