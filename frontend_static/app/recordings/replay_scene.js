import { element, setText } from "../element.js";
import { firstAtOrAfter } from "../session/telemetry_store.js";
import { fixed } from "../quantity.js";
import { sceneCaption } from "../scene.js";
import { SceneFrame } from "../scene_frame.js";
import { rest } from "../session/rest.js";
import { addressOf } from "./samples.js";

const PERIOD_MS = 50; // between poses, at least
const WORDS = {
  address: "/replay/",
  title: "3D view of the replay",
  problem: "The 3D scene of the replay could not be loaded. The plots work without it; it is tried again when a recording is opened.",
};

/** The actuator as it stood at the replay's position; the server poses it, asked at most twenty times a second. */
export class ReplayScene {
  #wanted = null;
  #isSending = false;
  #id = null;

  constructor(theme) {
    this.caption = element("p", { class: "scene-caption" });
    this.root = element("section", { class: "replay-scene", "aria-label": "Scene of the replay" }, this.caption);
    this.frame = new SceneFrame(this.root, WORDS, theme);
  }

  open(id) {
    this.#id = id;
    if (id) this.frame.load();
  }

  /** Ask for the pose at a time of the recording. */
  pose(time_s) {
    if (!this.#id) return;
    this.#wanted = { id: this.#id, time_s };
    if (!this.#isSending) this.#send();
  }

  /** Say what there is to see at a time. @param {object} picture samples at hand */
  describe(time, picture) {
    const at = Math.min(firstAtOrAfter(picture.time, time), picture.time.length - 1);
    const value = (name) => (at < 0 ? NaN : picture.column(name)[at]);
    const angle = `t ${fixed(time, 2)} s · link ${fixed(value("link_position"), 2)} rad`;
    setText(this.caption, `${angle}\n${sceneCaption(value("stiffness"), value("deflection"))}`);
  }

  async #send() {
    this.#isSending = true;
    while (this.#wanted) {
      const { id, time_s } = this.#wanted;
      this.#wanted = null;
      const begun = performance.now();
      try {
        await rest("POST", addressOf(id, "scene"), { time_s });
      } catch {
        this.#id = null; // the frame itself says what is wrong; it is tried again with the next recording
        break;
      }
      await new Promise((resolve) => setTimeout(resolve, Math.max(0, PERIOD_MS - (performance.now() - begun))));
    }
    this.#isSending = false;
    if (!this.#id) this.#wanted = null;
  }
}
