import { setText } from "../element.js";
import { fixed } from "../quantity.js";

const PACES = [0.1, 0.25, 0.5, 1, 2];
const RUNNING = new Set(["running"]);
const STARTABLE = new Set(["ready", "paused"]);
const LATCHED = new Set(["stopped", "fault"]);

/** Pause or resume, single step, reset, and how fast the simulated time runs. Of a rig, only the way out of a stop. */
export class RunControls {
  constructor(operator, resetDialog) {
    const { session } = operator;
    this.operator = operator;
    this.session = session;
    this.resetDialog = resetDialog;
    this.pauseButton = document.getElementById("pause");
    this.stepButton = document.getElementById("step");
    this.resetButton = document.getElementById("reset");
    this.pace = document.getElementById("pace");
    this.achieved = document.getElementById("pace-achieved");
    this.pauseButton.addEventListener("click", () => this.pauseOrResume());
    this.stepButton.addEventListener("click", () => this.step());
    this.resetButton.addEventListener("click", () => this.askReset());
    this.pace.addEventListener("change", () => this.#ask("set_pace", { factor: Number(this.pace.value) }));
    for (const pace of PACES) this.#offer(pace);
    session.addEventListener("snapshot", () => this.#show());
    session.addEventListener("connection", () => this.#show());
    this.#show();
  }

  pauseOrResume() {
    if (this.operator.isOnRig) return;
    const state = this.session.snapshot?.state;
    if (RUNNING.has(state)) this.#ask("pause");
    else if (STARTABLE.has(state)) this.#ask("resume");
  }

  step() {
    if (!this.operator.isOnRig && this.session.snapshot?.state === "paused") this.#ask("step", { samples: 1 });
  }

  askReset() {
    if (this.session.isConnected) this.resetDialog.ask(this.session.snapshot, () => this.#ask("reset"));
  }

  #ask(command, args) {
    this.session.command(command, args).catch((refusal) => {
      this.session.note(refusal.message);
      this.#show();
    });
  }

  #show() {
    const { snapshot, isConnected } = this.session;
    const state = snapshot?.state;
    const isRunning = RUNNING.has(state);
    this.pauseButton.disabled = !isConnected || !(isRunning || STARTABLE.has(state));
    this.pauseButton.dataset.icon = isRunning || !STARTABLE.has(state) ? "pause" : "resume";
    const label = isRunning ? "Pause" : state === "ready" ? "Run" : "Resume";
    this.pauseButton.setAttribute("aria-label", label);
    this.pauseButton.title =
      this.pauseButton.disabled && isConnected ? `${label}: not while ${state}. Reset first.` : `${label} (Space)`;
    this.stepButton.hidden = state !== "paused";
    for (const control of [this.stepButton, this.resetButton, this.pace]) control.disabled = !isConnected;
    if (!snapshot) return;
    this.#leaveOut(state);
    const { asked, achieved } = snapshot.pace;
    this.#offer(asked);
    if (document.activeElement !== this.pace || this.pace.disabled) this.pace.value = String(asked);
    const isBehind = isRunning && !this.operator.isOnRig && Math.abs(achieved / asked - 1) > 0.02;
    setText(this.achieved, isBehind ? `${fixed(achieved, 2)}× achieved` : "");
    this.achieved.hidden = !isBehind;
    this.pace.title = `Real-time factor: ${asked} asked, ${fixed(achieved, 3)} achieved`;
  }

  /** A rig has no time to hold: what could is not there. */
  #leaveOut(state) {
    const { isOnRig, mayChange } = this.operator;
    this.pauseButton.hidden = this.pace.parentElement.hidden = isOnRig;
    this.resetButton.hidden = isOnRig && !LATCHED.has(state);
    if (isOnRig) this.stepButton.hidden = true;
    if (isOnRig) this.resetButton.disabled = !mayChange;
    this.resetButton.title = isOnRig ? "Reset: take back the stop; the drives stay off" : "Reset: back to t = 0";
  }

  #offer(pace) {
    if ([...this.pace.options].some((option) => option.value === String(pace))) return;
    this.pace.append(new Option(`${pace}×`, pace));
  }
}
