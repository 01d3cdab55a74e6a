import { element, setText } from "../element.js";
import { fixed } from "../quantity.js";
import { Replay } from "./replay.js";

const POSITIONS = 10_000;

/** Play and pause, speed, and the bar whose knob is the position in the recording. */
export class ReplayBar {
  /** @param {Replay} replay */
  constructor(replay) {
    this.replay = replay;
    this.button = element("button", {
      type: "button",
      class: "replay-button",
      "data-icon": "resume",
      click: () => replay.toggle(),
    });
    this.speed = element("select", {
      "aria-label": "Speed of the replay",
      change: () => (replay.speed = Number(this.speed.value)),
    });
    this.speed.append(...Replay.speeds.map((speed) => new Option(`${speed}×`, speed)));
    this.speed.value = replay.speed;
    this.knob = element("input", {
      type: "range",
      min: 0,
      max: POSITIONS,
      step: 1,
      "aria-label": "Position in the recording",
      input: () => replay.seek(this.#time(Number(this.knob.value))),
      keydown: (event) => this.#key(event),
    });
    this.clock = element("output", { class: "replay-clock" });
    this.root = element("div", { class: "replay-bar", role: "group", "aria-label": "Replay" }, this.button, this.speed, this.knob, this.clock);
    replay.addEventListener("change", () => this.#show());
    this.#show();
  }

  #time(knob) {
    const [from, to] = this.replay.extent;
    return from + (knob / POSITIONS) * (to - from);
  }

  /** One step is a hundredth of the recording; the space bar plays, as elsewhere. */
  #key(event) {
    const step = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -10, PageUp: 10 }[event.key];
    const [from, to] = this.replay.extent;
    if (event.key === " ") this.replay.toggle();
    else if (step) this.replay.seek(this.replay.position + (step * (to - from)) / 100);
    else return;
    event.preventDefault();
  }

  #show() {
    const { extent, position, isPlaying } = this.replay;
    const [from, to] = extent;
    const share = to > from ? (position - from) / (to - from) : 0;
    this.knob.value = Math.round(share * POSITIONS);
    this.knob.style.setProperty("--share", share);
    this.knob.setAttribute("aria-valuetext", `${fixed(position, 2)} s`);
    this.button.dataset.icon = isPlaying ? "pause" : "resume";
    const words = isPlaying ? "Pause the replay" : "Play the recording";
    this.button.setAttribute("aria-label", words);
    this.button.title = `${words} (Space)`;
    setText(this.clock, `${fixed(position, 2)} of ${fixed(to, 2)} s`);
    const longest = `${fixed(to, 2)} of ${fixed(to, 2)} s`.length;
    this.clock.style.minWidth = `${longest - 1}ch`;
  }
}
