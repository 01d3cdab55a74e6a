import { element, setText } from "../element.js";
import { decimalsFor, fixed } from "../quantity.js";
import { RigPanel } from "./rig_panel.js";

const AXES = { motor: "motor", stiffness: "stiffness" };
const OLD_CYCLES = 1;
const PERIOD_MS = 200;

/** Both drives: their state in words, where they are, torque asked and seen, how old that is, and what ails them. */
export class DrivePanel {
  /** @param {object} desk {session, operator, choices} */
  constructor({ session, operator, choices }) {
    Object.assign(this, { session, operator, choices });
    this.rows = new Map(Object.keys(AXES).map((axis) => [axis, driveRow(AXES[axis])]));
    const head = ["", "state", "position", "asked", "seen", "age"].map((text, i) => element("th", { scope: "col", class: i > 1 ? "figure" : null }, text || element("span", { class: "unseen" }, "axis")));
    this.table = element(
      "table",
      { class: "drive-table" },
      element("thead", {}, element("tr", {}, ...head)),
      element("tbody", {}, ...[...this.rows.values()].map(({ root }) => root), this.#linkRow()),
    );
    this.errors = element("p", { class: "rig-note", "data-tone": "fault", hidden: true });
    this.panel = new RigPanel("Drives", this.table, this.errors);
    this.root = this.panel.root;
    session.addEventListener("snapshot", () => this.#show());
    for (const source of [operator, choices]) source.addEventListener("change", () => this.#show());
    setInterval(() => this.#showPositions(), PERIOD_MS);
    this.#show();
  }

  #linkRow() {
    this.linkState = element("td", {});
    this.linkPosition = element("td", { class: "figure" });
    this.linkAge = element("td", { class: "figure" });
    return element("tr", {}, element("th", { scope: "row" }, "link"), this.linkState, this.linkPosition, element("td", {}), element("td", {}), this.linkAge);
  }

  #show() {
    const { operator, choices } = this;
    const { rig, isOnRig } = operator;
    const axes = isOnRig ? (rig.axes ?? []) : [];
    for (const [name, row] of this.rows) {
      const axis = axes.find((each) => each.axis === name);
      const shown = name === "motor" ? choices.motorTorque(rig) : { unit: "N·m", factor: 1 };
      const greatest = name === "motor" ? rig.limits?.motor_torque : rig.limits?.stiffness_torque;
      const decimals = decimalsFor((greatest ?? 1) * shown.factor);
      const status = axis ? `status word 0x${axis.status_word.toString(16).padStart(4, "0")}` : "";
      setText(row.state, axis?.words ?? "–");
      row.state.title = status;
      row.root.dataset.state = axis?.state ?? "unknown";
      torque(row.asked, axis?.torque, shown, decimals);
      torque(row.seen, axis?.torque_seen, shown, decimals);
      age(row.age, axis?.age);
    }
    setText(this.linkState, isOnRig ? "encoder" : "–");
    age(this.linkAge, isOnRig ? rig.link_age : undefined);
    const ailing = axes.filter(({ error_code, error_words }) => error_code || error_words);
    const words = ailing.map(({ axis, error_code, error_words }) => `${axis} drive: ${error_words || `error 0x${error_code.toString(16)}`}`);
    setText(this.errors, words.join("; "));
    this.errors.hidden = words.length === 0;
    this.#showPositions();
  }

  #showPositions() {
    const { store } = this.session;
    const { rig, isOnRig } = this.operator;
    if (this.root.offsetParent === null) return;
    const motor = this.choices.motorAngle(rig);
    const { linkAngle } = this.choices;
    position(this.rows.get("motor").position, isOnRig ? store.latest("motor_position") : NaN, motor);
    position(this.rows.get("stiffness").position, isOnRig ? store.latest("stiffness_motor_position") : NaN, linkAngle);
    position(this.linkPosition, isOnRig ? store.latest("link_position") : NaN, linkAngle);
  }
}

function driveRow(name) {
  const cells = { state: element("td", { class: "drive-state" }) };
  for (const cell of ["position", "asked", "seen", "age"]) cells[cell] = element("td", { class: "figure" });
  return { ...cells, root: element("tr", {}, element("th", { scope: "row" }, name), ...Object.values(cells)) };
}

function torque(cell, value, { unit, factor }, decimals) {
  figure(cell, fixed(typeof value === "number" ? value * factor : null, decimals), unit);
}

function position(cell, value, { unit, factor }) {
  figure(cell, fixed(value * factor, unit === "°" ? 1 : 3), unit);
}

/** A number with its small unit; both are kept, only their texts change. */
function figure(cell, text, unit) {
  if (!cell.firstElementChild) cell.append(element("span", {}), element("small", {}));
  setText(cell.firstElementChild, text);
  setText(cell.lastElementChild, text === "–" ? "" : ` ${unit}`);
}

function age(cell, cycles) {
  setText(cell, cycles === undefined ? "–" : String(cycles));
  cell.title = cycles === undefined ? "" : cycles ? `${cycles} cycles without news` : "new in this cycle";
  cell.classList.toggle("is-warning", cycles > OLD_CYCLES);
}
