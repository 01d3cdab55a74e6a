import { element, setText } from "../element.js";
import { MOVABLE } from "../session/jog.js";
import { RigPanel } from "./rig_panel.js";
import { SpeedSlider } from "./speed_slider.js";

const WAYS = [
  { id: "softer", key: "ArrowDown", text: "softer", sign: "▼", part: "stiffness", way: -1 },
  { id: "left", key: "ArrowLeft", text: "left", sign: "◀", part: "link", way: -1 },
  { id: "right", key: "ArrowRight", text: "right", sign: "▶", part: "link", way: 1 },
  { id: "stiffer", key: "ArrowUp", text: "stiffer", sign: "▲", part: "stiffness", way: 1 },
];

/** Hold to move: by pointer on a button, or by the arrow keys while the pad has focus. Letting go stops, whatever way. */
export class JogPad {
  #held = new Set(); // ids of what is held
  #told = ""; // the problem of the jog that was shown last

  /** @param {object} desk {session, operator, jog, choices} */
  constructor({ session, operator, jog, choices }) {
    Object.assign(this, { session, operator, jog, choices });
    this.linkSpeed = new SpeedSlider("link speed");
    this.stiffnessSpeed = new SpeedSlider("stiffness speed");
    this.buttons = new Map(WAYS.map((way) => [way.id, this.#button(way)]));
    this.pad = element(
      "div",
      { class: "jog-pad", tabindex: "0", role: "group", "aria-label": "Jog pad: hold the arrow keys, left and right for the link, down and up for the stiffness" },
      ...this.buttons.values(),
    );
    this.pad.addEventListener("keydown", (event) => this.#keyDown(event));
    this.pad.addEventListener("keyup", (event) => this.#keyUp(event));
    this.pad.addEventListener("focusout", () => this.#letGo());
    this.hint = element("p", { class: "hint" });
    this.panel = new RigPanel("Jog", this.pad, this.hint, this.linkSpeed.root, this.stiffnessSpeed.root);
    this.root = this.panel.root;
    for (const { slider } of [this.linkSpeed, this.stiffnessSpeed]) slider.addEventListener("input", () => this.#held.size && this.#move());
    jog.addEventListener("change", () => this.#jogged());
    session.addEventListener("snapshot", () => this.#show());
    operator.addEventListener("change", () => this.#show());
    choices.addEventListener("change", () => this.#show());
    this.#show();
  }

  #button({ id, text, sign }) {
    const button = element(
      "button",
      { type: "button", class: "jog-button", tabindex: "-1", "data-way": id, "aria-label": `Jog ${text}` },
      element("span", { "aria-hidden": "true" }, sign),
      element("span", {}, text),
    );
    button.addEventListener("pointerdown", (event) => this.#press(event, id));
    for (const type of ["pointerup", "pointercancel", "pointerleave", "lostpointercapture"]) button.addEventListener(type, () => this.#release(id));
    button.addEventListener("contextmenu", (event) => event.preventDefault());
    return button;
  }

  /** A finger that slides off lets go: a touch is captured by itself, so the capture is given back. */
  #press(event, id) {
    if (event.button !== 0 || !event.isPrimary) return;
    event.preventDefault();
    this.pad.focus({ preventScroll: true });
    if (event.target.hasPointerCapture?.(event.pointerId)) event.target.releasePointerCapture(event.pointerId);
    this.#hold(id);
  }

  #keyDown(event) {
    const way = WAYS.find(({ key }) => key === event.key);
    if (!way || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    if (!event.repeat) this.#hold(way.id);
  }

  #keyUp(event) {
    const way = WAYS.find(({ key }) => key === event.key);
    if (way) this.#release(way.id);
  }

  #hold(id) {
    if (!this.isPossible) return;
    this.panel.say("");
    this.#held.add(id);
    this.#move();
  }

  #release(id) {
    if (this.#held.delete(id)) this.#move();
  }

  #letGo() {
    this.#held.clear();
    this.jog.end();
  }

  #move() {
    const velocity = { link: 0, stiffness: 0 };
    for (const { id, part, way } of WAYS) if (this.#held.has(id)) velocity[part] += way;
    velocity.link *= this.linkSpeed.speed;
    velocity.stiffness *= this.stiffnessSpeed.speed;
    this.jog.hold(velocity);
  }

  /** What has ended for another reason than letting go begins again only with a new press. */
  #jogged() {
    if (!this.jog.isHeld) this.#held.clear();
    for (const [id, button] of this.buttons) button.dataset.held = String(this.#held.has(id));
    if (this.jog.problem !== this.#told) this.panel.say((this.#told = this.jog.problem));
  }

  get isPossible() {
    const { operator, session } = this;
    return operator.isOnRig && operator.mayChange && MOVABLE.has(session.snapshot?.state);
  }

  #show() {
    const { isPossible, operator, session, choices } = this;
    const { limits } = operator.rig;
    for (const button of this.buttons.values()) button.disabled = !isPossible;
    this.pad.setAttribute("aria-disabled", String(!isPossible));
    this.linkSpeed.scale(limits?.jog_speed, choices.linkSpeed);
    this.stiffnessSpeed.scale(limits?.stiffness_jog, { unit: "N·m/rad/s", factor: 1 });
    for (const { slider } of [this.linkSpeed, this.stiffnessSpeed]) slider.disabled = !isPossible;
    setText(this.hint, isPossible ? "Hold a button, or arrow keys on the pad." : this.#why(session.snapshot?.state));
  }

  #why(state) {
    if (!this.operator.isOnRig) return "Once a rig is armed.";
    return this.operator.why || (state === "homing" ? "Not while homing." : "Arm first.");
  }
}
