import { element, setText } from "../element.js";
import { fixed } from "../quantity.js";
import { TimeWindow } from "./time_window.js";

/** The line above the charts: time window and freeze of a live source, cursors, and what they measure. */
export class PlotToolbar {
  constructor(root, stack) {
    const { isLive } = stack.source;
    this.timeWindow = stack.timeWindow;
    this.cursors = stack.cursors;
    this.stack = stack;
    this.select = element("select", {
      "aria-label": "Time window",
      change: () => this.timeWindow.choose(Number(this.select.value)),
    });
    this.select.append(...TimeWindow.choices.map((seconds) => new Option(`${seconds} s`, seconds)));
    this.select.value = this.timeWindow.seconds;
    this.freezeButton = this.#button("Freeze", "F", "Stop the picture; the recording goes on", () =>
      this.toggleFreeze(),
    );
    this.cursorsButton = this.#button("Cursors", "C", "Measure: click sets A, the next click B", () =>
      this.cursors.toggle(),
    );
    this.followButton = element(
      "button",
      { type: "button", class: "follow", hidden: true, click: () => stack.followAgain() },
      isLive ? "Follow" : "Whole",
    );
    this.readout = element("output", { class: "readout" });
    root.append(
      ...(isLive ? [element("label", { class: "tool" }, "window ", this.select), this.freezeButton] : []),
      this.cursorsButton,
      this.followButton,
      this.readout,
    );
    for (const source of [this.timeWindow, this.cursors]) source.addEventListener("change", () => this.#show());
    this.#show();
  }

  toggleFreeze() {
    if (this.timeWindow.isHeld) this.timeWindow.follow();
    else this.timeWindow.freeze();
  }

  #button(text, key, title, click) {
    return element(
      "button",
      { type: "button", class: "tool", title, "aria-pressed": "false", click },
      text,
      element("kbd", {}, key),
    );
  }

  #show() {
    const { timeWindow, cursors } = this;
    this.freezeButton.setAttribute("aria-pressed", String(timeWindow.isHeld));
    this.cursorsButton.setAttribute("aria-pressed", String(cursors.isOn));
    this.followButton.hidden = !timeWindow.isHeld;
    this.stack.area.dataset.measuring = String(cursors.isOn);
    setText(this.readout, [this.#held(), this.#measured()].filter(Boolean).join("   "));
  }

  #held() {
    const { held } = this.timeWindow;
    if (!held) return "";
    const [from, to] = held.range;
    return held.isZoomed ? `zoomed ${fixed(from, 2)} to ${fixed(to, 2)} s` : `frozen at ${fixed(to, 2)} s`;
  }

  #measured() {
    const { isOn, a, b, span } = this.cursors;
    if (!isOn) return "";
    if (!a) return "click a plot to set A";
    if (!b) return `A ${fixed(a.time, 3)} s   click to set B`;
    const rate = span === 0 ? "" : `   1/Δt ${fixed(1 / Math.abs(span), 2)} Hz`;
    return `A ${fixed(a.time, 3)} s   B ${fixed(b.time, 3)} s   Δt ${fixed(span, 3)} s${rate}`;
  }
}
