import { TaskBoard } from "../analyse/task_board.js";
import { element, setText } from "../element.js";
import { displayUnit, significant } from "../quantity.js";
import { addressOf } from "./samples.js";

const FIRST = ["link_position", "motor_torque", "spring_torque"];
const WAITS = "Waits for the tasks before it.";

/**
 * The same scenario, simulated anew: its progress, and what remains between the recording and the simulation.
 */
export class SimulatePanel {
  /** @param {TaskBoard} board @param {(id: string, result: object) => void} done a recording was simulated */
  constructor(board, done) {
    this.board = board;
    this.start = element("button", { type: "button", class: "start", click: () => this.#ask() }, "Simulate the same scenario");
    this.cancel = element("button", { type: "button", hidden: true, click: () => this.board.cancel(this.task) }, "Cancel");
    this.progress = element("progress", { max: 1, hidden: true, "aria-label": "Progress of the simulation" });
    this.words = element("p", { class: "form-hint", role: "status" });
    this.table = element("dl", { class: "facts" });
    this.others = element("dl", { class: "facts" });
    this.more = element("details", { hidden: true }, element("summary", {}, "All channels"), this.others);
    this.root = element(
      "section",
      { class: "side-panel", "aria-label": "Simulation" },
      element("h2", {}, "Simulation"),
      element("div", { class: "form-row" }, this.start, this.cancel),
      this.progress,
      this.words,
      this.table,
      this.more,
    );
    board.addEventListener("change", () => this.#show());
    board.addEventListener("result", ({ detail }) => detail.asked && done(detail.asked.recording, detail.result));
  }

  open(facts) {
    this.facts = facts;
    this.problem = "";
    this.say("");
    this.tell(null);
    this.start.disabled = facts.origin !== "live" || !facts.scenario;
    this.start.title = this.start.disabled
      ? "Only a recording of the live session can be simulated: it holds its scenario"
      : "Computed anew from the scenario and the changes made in it, and laid over the recording";
    this.#show();
  }

  /** Show RMS and peak of the residual of each channel. */
  tell(result) {
    const all = Object.entries(result?.residual ?? {});
    const isFirst = ([channel]) => FIRST.includes(channel);
    this.table.replaceChildren(...all.filter(isFirst).flatMap((line) => this.#line(line)));
    this.others.replaceChildren(...all.filter((line) => !isFirst(line)).flatMap((line) => this.#line(line)));
    this.more.hidden = all.length <= FIRST.length;
    const first = result?.first_difference_s;
    this.verdict = !result ? "" : first === null || first === undefined ? "The simulation is the same, sample by sample." : `They differ from ${significant(first)} s on. Residual, RMS and peak:`;
    this.#show();
  }

  #line([channel, { rms, peak, unit }]) {
    const shown = displayUnit(unit);
    const words = [rms, peak].map((value) => significant(value === null ? null : value * shown.factor)).join(" · ");
    const label = this.facts.channels.find(({ name }) => name === channel)?.label ?? channel;
    return [element("dt", { title: label }, label), element("dd", {}, `${words} ${shown.unit}`)];
  }

  /** A sentence about the residual's chart. */
  say(sentence) {
    this.about = sentence;
    this.#show();
  }

  async #ask() {
    this.problem = "";
    const { id } = this.facts;
    try {
      await this.board.ask({}, { recording: id }, addressOf(id, "simulate"));
    } catch (refusal) {
      this.problem = refusal.message;
    }
    this.#show();
  }

  #show() {
    const own = (task) => this.board.about(task)?.recording === this.facts?.id;
    const task = (this.task = this.facts ? (this.board.tasks.find(own) ?? null) : null);
    const isActive = task !== null && TaskBoard.isActive(task);
    this.cancel.hidden = this.progress.hidden = !isActive;
    this.progress.value = task?.progress ?? 0;
    setText(this.words, [this.problem || taskWords(task), this.verdict, this.about].filter(Boolean).join(" "));
  }
}

function taskWords(task) {
  if (task?.state === "queued") return WAITS;
  if (task?.state === "running") return `${Math.round(100 * task.progress)} %${task.words ? `, ${task.words}` : ""}`;
  if (task?.state === "cancelled") return "Cancelled.";
  if (task?.state === "failed" || task?.state === "refused") return `Not simulated: ${task.reason}.`;
  return "";
}
