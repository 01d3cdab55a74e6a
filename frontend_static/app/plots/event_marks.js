import { element } from "../element.js";
import { fixed } from "../quantity.js";

const KINDS = {
  disturbance: "series-disturbance",
  tuning: "dim",
  stiffness: "series-stiffness",
  reference: "dim",
  sequence: "dim",
  limit: "warning",
  fault: "fault",
  trigger: "accent",
  state: "dim",
  rig: "dim",
};
const REACH_PX = 5;
const APART_PX = 8; // a dragged slider leaves many marks of one kind

/** @returns {object|null} an event as a mark, null if it has none @param {string} you name of this page in the session */
export function markOf({ kind, time_s, text, epoch, by }, you = "") {
  if (!KINDS[kind] || time_s === null || time_s === undefined) return null;
  return { time: time_s, text, epoch, colour: KINDS[kind], by: by && by === you ? "you" : by };
}

/** Thin vertical lines where something happened, with its word under the pointer. */
export class EventMarks {
  constructor() {
    this.tip = element("div", { class: "mark-tip", hidden: true });
    document.body.append(this.tip);
  }

  /** Draw the marks of the shown span into a chart. */
  static draw(plot, marks, palette) {
    const { ctx, bbox } = plot;
    const [from, to] = [plot.scales.x.min, plot.scales.x.max];
    const drawn = new Map();
    ctx.save();
    ctx.lineWidth = devicePixelRatio;
    ctx.setLineDash([3 * devicePixelRatio, 3 * devicePixelRatio]);
    for (const mark of marks) {
      const x = Math.round(plot.valToPos(mark.time, "x", true)) + 0.5;
      if (mark.time < from || mark.time > to || x - (drawn.get(mark.colour) ?? -Infinity) < APART_PX * devicePixelRatio)
        continue;
      drawn.set(mark.colour, x);
      ctx.strokeStyle = palette.faint(mark.colour, 0.6);
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
    }
    ctx.restore();
  }

  /** Show the words of the marks near a pointer position, in CSS px from the chart's left. */
  point(plot, left, marks) {
    const near = left < 0 ? [] : marks.filter((mark) => Math.abs(plot.valToPos(mark.time, "x") - left) <= REACH_PX);
    this.tip.hidden = near.length === 0;
    if (!near.length) return;
    const shown = near
      .slice(-4)
      .map((mark) => element("p", {}, `${mark.text} · ${fixed(mark.time, 2)} s${mark.by ? ` · ${mark.by}` : ""}`));
    this.tip.replaceChildren(...shown);
    const area = plot.over.getBoundingClientRect();
    const width = this.tip.offsetWidth;
    this.tip.style.left = `${Math.min(area.left + left + 8, innerWidth - width - 8)}px`;
    this.tip.style.top = `${area.top + 2}px`;
  }

  leave() {
    this.tip.hidden = true;
  }
}
