import { arrange, element, setText } from "../element.js";
import { RigAdd } from "./rig_add.js";
import { RigPanel, panelButton } from "./rig_panel.js";

const CHOSEN = "vssea.rig";

/** The rigs that can be connected, and who answers on the one that is. */
export class RigList {
  #lines = new Map();

  /** @param {object} desk {session, operator, actions, rigs, ask} */
  constructor({ session, operator, actions, rigs, ask }) {
    Object.assign(this, { session, operator, actions, rigs, ask });
    this.chosen = localStorage.getItem(CHOSEN);
    this.lines = element("div", { class: "rig-lines", role: "radiogroup", "aria-label": "Rigs" });
    this.empty = element("p", { class: "hint" });
    this.connectButton = panelButton("Connect", () => this.#connect());
    this.connectButton.classList.add("start");
    this.checkButton = panelButton("Check", () => this.#check(), "Ask who answers and compare; nothing is written, nothing moves");
    this.disconnectButton = panelButton("Disconnect", () => this.panel.tell(this.actions.disconnect()));
    this.editButton = panelButton("File", () => this.#edit(), "See or change its file");
    this.removeButton = panelButton("Remove", () => this.#remove(), "Delete its file");
    for (const button of [this.editButton, this.removeButton]) button.classList.add("quiet");
    this.buttons = element("div", { class: "rig-buttons" }, this.connectButton, this.checkButton, this.editButton, this.removeButton, this.disconnectButton);
    this.add = new RigAdd(rigs, (name) => this.#choose(name));
    this.found = element("div", { class: "rig-check", role: "status" });
    this.devices = element("dl", { class: "rig-devices", "aria-label": "Who answers" });
    this.panel = new RigPanel("Rig", this.lines, this.empty, this.buttons, this.found, this.devices, this.add.root);
    this.root = this.panel.root;
    rigs.addEventListener("change", () => this.#show());
    operator.addEventListener("change", () => this.#show());
    actions.addEventListener("change", () => this.#show());
    session.addEventListener("snapshot", () => this.#showDevices());
    this.#show();
  }

  #show() {
    const { list, problem } = this.rigs;
    const { rig, isOnRig } = this.operator;
    const known = list ?? [];
    if (!known.some(({ name }) => name === this.chosen)) this.chosen = known[0]?.name ?? this.chosen;
    const shown = isOnRig ? [this.rigs.get(rig.name) ?? { name: rig.name }] : known;
    arrange(this.lines, shown.map((each) => this.#line(each)));
    for (const [name, line] of this.#lines) line.setAttribute("aria-checked", String(name === (isOnRig ? rig.name : this.chosen)));
    setText(this.empty, problem ? `The rigs cannot be listed: ${problem}` : list ? "No rig is described yet." : "The rigs are being listed.");
    this.empty.hidden = isOnRig || known.length > 0;
    setText(this.panel.aside, isOnRig ? "connected" : "");
    const isBusy = this.actions.underWay !== "";
    const chosen = this.rigs.get(this.chosen);
    this.connectButton.hidden = this.checkButton.hidden = isOnRig || !chosen;
    this.connectButton.disabled = isBusy || !this.session.isConnected || Boolean(chosen?.problem);
    setText(this.connectButton, this.actions.underWay === "connect" ? "Connecting…" : "Connect");
    this.checkButton.disabled = isBusy || !this.session.isConnected || Boolean(chosen?.problem);
    this.editButton.hidden = this.removeButton.hidden = isOnRig || !chosen || chosen.builtin === true;
    this.add.root.hidden = isOnRig;
    this.disconnectButton.hidden = !isOnRig;
    this.disconnectButton.disabled = isBusy || !this.operator.mayChange;
    this.disconnectButton.title = this.operator.why || "Drives off, bus closed, back to the simulation";
    if (isOnRig) this.found.replaceChildren();
    this.#showDevices();
  }

  #line(rig) {
    const text = JSON.stringify(rig);
    const known = this.#lines.get(rig.name);
    if (known?.dataset.text === text) return known;
    const where = [rig.interface, rig.address].filter(Boolean).join(" ");
    const line = element(
      "button",
      { type: "button", role: "radio", class: "rig-line", "data-rig-name": rig.name, "data-text": text, click: () => this.#choose(rig.name) },
      element("span", { class: "rig-line-name" }, rig.name),
      element("span", { class: "rig-line-rate" }, rig.rate_hz ? `${rig.rate_hz} Hz` : ""),
      where ? element("span", { class: "rig-line-where", title: where }, where) : null,
      rig.note ? element("span", { class: "rig-line-note", title: rig.note }, rig.note) : null,
      rig.problem ? element("span", { class: "rig-line-problem" }, rig.problem) : null,
    );
    this.#lines.set(rig.name, line);
    return line;
  }

  #choose(name) {
    if (this.operator.isOnRig) return;
    this.chosen = name;
    localStorage.setItem(CHOSEN, name);
    this.found.replaceChildren();
    this.panel.say("");
    this.#show();
  }

  #connect() {
    this.found.replaceChildren();
    return this.panel.tell(this.actions.connect(this.chosen));
  }

  async #edit() {
    try {
      this.add.show(await this.rigs.text(this.chosen));
    } catch (refusal) {
      this.panel.say(refusal.message);
    }
  }

  async #remove() {
    const name = this.chosen;
    if (await this.ask.sure(`Remove ${name}?`, "Its file is deleted.", "Remove")) await this.panel.tell(this.rigs.remove(name));
  }

  async #check() {
    this.panel.say("");
    this.checkButton.disabled = true;
    this.found.replaceChildren(element("p", { class: "hint" }, `Asking the nodes of ${this.chosen}…`));
    try {
      const { ok, lines } = await this.rigs.check(this.chosen);
      this.found.replaceChildren(checkHead(ok), ...lines.map(checkLine));
    } catch (refusal) {
      this.found.replaceChildren();
      this.panel.say(refusal.message);
    }
    this.#show();
  }

  #showDevices() {
    const devices = this.operator.isOnRig ? (this.operator.rig.devices ?? []) : [];
    const text = JSON.stringify(devices);
    this.devices.hidden = devices.length === 0;
    if (this.devices.dataset.text === text) return;
    this.devices.dataset.text = text;
    this.devices.replaceChildren(...devices.flatMap(([where, what]) => [element("dt", {}, where), element("dd", {}, what)]));
  }
}

function checkHead(ok) {
  return element("p", { class: "check-head", "data-ok": String(ok) }, ok ? "It is what its file says." : "It is not as its file says.");
}

function checkLine({ what, found, expected, ok, sentence }) {
  const words = [found, ok || !expected ? "" : `expected ${expected}`].filter(Boolean).join(", ");
  return element(
    "p",
    { class: "check-line", "data-ok": String(ok) },
    element("span", { class: "check-mark", "aria-label": ok ? "good" : "not good", role: "img" }, ok ? "✓" : "✗"),
    element("span", { class: "check-what" }, what),
    element("span", { class: "check-words" }, words),
    ok || !sentence ? null : element("span", { class: "check-sentence" }, sentence),
  );
}
