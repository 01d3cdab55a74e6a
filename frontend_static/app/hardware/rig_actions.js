import { commandedStiffness } from "../document/commanded_stiffness.js";

const CONNECT_LIMIT_MS = 90_000; // a new control process, and every node configured
const HOME_LIMIT_MS = 60_000;
const STOP_LIMIT_MS = 20_000;

/** What an operator can ask of the rig. Only what cannot be taken back, and arming a real one, is confirmed first. */
export class RigActions extends EventTarget {
  /** @param {import("../session/operator.js").Operator} operator @param {object} dialogs {ask: AskDialog, reset: ResetDialog} */
  constructor(operator, { ask, reset }) {
    super();
    this.operator = operator;
    this.session = operator.session;
    this.ask = ask;
    this.resetDialog = reset;
    this.underWay = ""; // name of a command that takes its time
  }

  askControl() {
    return this.operator.ask();
  }

  takeControl() {
    return this.operator.take();
  }

  /** Connect, and be in control. */
  async connect(name) {
    await this.#slowly("connect", this.session.command("connect_rig", { rig: name }, CONNECT_LIMIT_MS));
    this.operator.begin();
  }

  disconnect() {
    return this.#slowly("disconnect", this.session.command("disconnect_rig", {}, STOP_LIMIT_MS));
  }

  home() {
    return this.session.command("home_stiffness", {}, HOME_LIMIT_MS);
  }

  async arm() {
    const { kind, name } = this.operator.rig;
    if (kind === "real" && !(await this.#isSure(name))) return undefined;
    return this.session.command("arm", {}, STOP_LIMIT_MS);
  }

  disarm() {
    return this.session.command("disarm", {}, STOP_LIMIT_MS);
  }

  follow() {
    return this.session.command("follow");
  }

  hold() {
    return this.session.command("hold");
  }

  goTo(position, speed) {
    return this.session.command("go_to", { position, speed });
  }

  setStiffness(stiffness) {
    return this.session.command("set_stiffness", { replace: { kind: "constant", stiffness } });
  }

  /** The stiffness that is asked for at present [N m/rad]. */
  get stiffness() {
    return commandedStiffness(this.session.document);
  }

  reset() {
    return new Promise((resolve, reject) => {
      this.resetDialog.ask(this.session.snapshot, () => this.session.command("reset", {}, STOP_LIMIT_MS).then(resolve, reject));
    });
  }

  #isSure(name) {
    const text = `Both drives of ${name} go into operation and hold where they are. Nobody may be within reach of the link; a hand on the hardware stop.`;
    return this.ask.sure(`Arm the REAL rig ${name}?`, text, "Arm");
  }

  async #slowly(name, answer) {
    this.#mark(name);
    try {
      return await answer;
    } finally {
      this.#mark("");
    }
  }

  #mark(name) {
    this.underWay = name;
    this.dispatchEvent(new Event("change"));
  }
}
