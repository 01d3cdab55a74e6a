import { LiveMarks } from "./live_marks.js";

/**
 * The running session as something to plot. A source of a PlotStack has
 *
 * - `channels`: Map of name to {label, unit}; event `channels` when it is known or another,
 * - `isLive`: whether the newest sample is followed; else `extent`, [first, last] time in s, is the widest span,
 * - `isEmpty`, `lastTime` in s,
 * - `picture([from, to], pixels)`: the samples at hand for a span, {time, column(name), isExact},
 * - `hold()`: {picture, marks} that stay while more is recorded, null for what needs no holding,
 * - `marks`: {time, text, colour, by} of what happened, `overlays` (overlay_lines.js) to draw beneath,
 * - `version(secondsPerPixel)`: differs when there is more to draw; event `change` when all is to be drawn anew,
 * - event `cleared` when what was plotted is no more.
 */
export class LiveSource extends EventTarget {
  #marks;

  constructor(session) {
    super();
    this.session = session;
    this.isLive = true;
    this.ghosts = null; // pins/ghosts.js
    this.#marks = new LiveMarks(session);
    session.addEventListener("hello", () => this.dispatchEvent(new Event("channels")));
    session.addEventListener("log", () => this.dispatchEvent(new Event("change")));
    session.store.addEventListener("cleared", () => this.dispatchEvent(new Event("cleared")));
  }

  get channels() {
    return this.session.channels;
  }

  get isEmpty() {
    return this.session.store.length === 0;
  }

  get lastTime() {
    return this.session.store.lastTime;
  }

  get marks() {
    return this.#marks.list;
  }

  get overlays() {
    return this.ghosts?.lines ?? [];
  }

  picture() {
    return this.session.store;
  }

  hold() {
    return { picture: this.session.store.copy(), marks: [...this.marks] };
  }

  /** While it runs, or a rig is connected, changes when following the newest sample moves the picture by a pixel. */
  version(secondsPerPixel) {
    const { store, snapshot } = this.session;
    const beneath = this.ghosts?.version ?? 0;
    if (snapshot?.state !== "running" && !snapshot?.rig.connected) return `${store.version}/${beneath}`;
    return `${beneath}/${store.epoch}:${store.length > 0}:${Math.ceil(store.lastTime / secondsPerPixel)}`;
  }
}
