import { element } from "../element.js";
import { readNumber } from "../quantity.js";
import { NumberBox } from "./number_box.js";
import { row } from "./subject_panel.js";
import { TaskForm } from "./task_form.js";

const STIFFNESSES = "20 50 100 200 400 800 1000";

/** At which stiffnesses, for which true plants and margins the stable observer bandwidths are wanted. */
export class BandwidthForm {
  constructor(subject, board) {
    this.subject = subject;
    this.board = board;
    this.stiffnesses = element("input", { type: "text", "aria-label": "Stiffnesses, N·m/rad", autocomplete: "off" });
    this.stiffnesses.value = STIFFNESSES;
    this.low = new NumberBox("lowest bandwidth");
    this.high = new NumberBox("highest bandwidth");
    this.link = { low: new NumberBox("lowest link inertia"), high: new NumberBox("highest link inertia") };
    this.gain = new NumberBox("least gain margin");
    this.phase = new NumberBox("least phase margin", 180 / Math.PI);
    this.delay = new NumberBox("least delay margin", 1e3);
    for (const [box, value] of [
      [this.low, 5],
      [this.high, 1000],
      [this.link.low, 1],
      [this.link.high, 1],
      [this.gain, 1],
      [this.phase, 0],
      [this.delay, 0],
    ])
      box.set(value);
    const unit = (text) => element("span", { class: "form-unit" }, text);
    this.form = new TaskForm(
      "Stable bandwidths",
      [
        element("p", { class: "form-hint" }, "There is no single border in g, but intervals; mismatch gives islands."),
        row("at k", this.stiffnesses, unit("N·m/rad")),
        row("g from", this.low.root, unit("to"), this.high.root, unit("rad/s")),
        row("true J_l", this.link.low.root, unit("to"), this.link.high.root, unit("× assumed")),
        row("margins", this.gain.root, unit("× gain"), this.phase.root, unit("°")),
        row("", this.delay.root, unit("ms of delay")),
      ],
      "Compute the bandwidths",
      () => this.ask(),
    );
    this.root = this.form.root;
  }

  async ask() {
    const gain = this.gain.read();
    const factors = [...new Set([1, this.link.low.read(), this.link.high.read()])];
    const body = {
      ...this.subject.request,
      kind: "bandwidth_sets",
      stiffnesses: this.stiffnesses.value.split(/[\s;]+/).filter(Boolean).map(stiffness),
      mismatches: factors.map((factor) => (factor === 1 ? {} : { link_inertia: factor })),
      least: { gain_up: gain, gain_down: 1 / gain, phase: this.phase.read(), delay_s: this.delay.read() },
      low: this.low.read(),
      high: this.high.read(),
    };
    await this.board.ask(body, { words: factors.length > 1 ? `link inertia ×${factors.join(", ×")}` : "" });
  }
}

function stiffness(text) {
  const value = readNumber(text);
  if (!(value > 0)) throw new Error(`“${text}” is no stiffness; expected numbers above 0 N·m/rad, with spaces between.`);
  return value;
}
