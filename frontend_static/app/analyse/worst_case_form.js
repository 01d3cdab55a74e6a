import { element } from "../element.js";
import { Segmented } from "../parameters/segmented.js";
import { NumberBox } from "./number_box.js";
import { row } from "./subject_panel.js";
import { TaskForm } from "./task_form.js";

const BOX = {
  link_inertia: ["link J_l", 0.7, 1.5, true],
  motor_inertia: ["motor J_e", 0.9, 1.1, true],
  spring: ["spring k", 0.8, 1.25, true],
  link_damping: ["damping B_l", 0.5, 2, false],
  motor_damping: ["damping B_e", 0.5, 2, false],
  delay_s: ["delay", 0, 1e-3, true],
};

/** Within which box the worst true plant is looked for. */
export class WorstCaseForm {
  constructor(axes, subject, board) {
    this.subject = subject;
    this.board = board;
    this.rows = Object.entries(BOX).map(([name, entry]) => new BoxRow(axes.find((axis) => axis.name === name), entry));
    this.criterion = new Segmented(
      "Worst by",
      [
        { value: "disk", text: "disk margin", title: "The plant with the smallest disk margin; an unstable one is worse" },
        { value: "growth", text: "decay", title: "The plant whose slowest mode decays least, or grows most" },
      ],
      (criterion) => this.#choose(criterion),
    );
    this.#choose("disk");
    this.form = new TaskForm(
      "Worst case in a box",
      [
        element("p", { class: "form-hint" }, "Factors of the true plant; delay in ms. A search, not a proof; the worst plant is simulated."),
        ...this.rows.map(({ root }) => root),
        row("worst by", this.criterion.root),
      ],
      "Search the worst case",
      () => this.ask(),
    );
    this.root = this.form.root;
  }

  async ask() {
    const chosen = this.rows.filter(({ isChosen }) => isChosen);
    if (!chosen.length) throw new Error("No parameter is chosen; choose at least one to vary.");
    const box = Object.fromEntries(chosen.map((each) => [each.axis.name, each.read()]));
    await this.board.ask(
      { ...this.subject.request, kind: "worst_case", box, criterion: this.wanted },
      { words: `${chosen.length} parameter${chosen.length > 1 ? "s" : ""}`, box },
    );
  }

  #choose(criterion) {
    this.wanted = criterion;
    this.criterion.show(criterion);
  }
}

class BoxRow {
  constructor(axis, [words, low, high, isChosen]) {
    this.axis = axis;
    this.check = element("input", { type: "checkbox", checked: isChosen, "aria-label": `vary ${axis.label}` });
    this.low = new NumberBox(`lowest ${axis.label}`, axis.factor);
    this.high = new NumberBox(`highest ${axis.label}`, axis.factor);
    this.low.set(low);
    this.high.set(high);
    const unit = (text) => element("span", { class: "form-unit" }, text);
    this.root = element(
      "div",
      { class: "form-row box-row" },
      element("label", { title: axis.label }, this.check, element("span", { class: "form-name" }, words)),
      this.low.root,
      unit("to"),
      this.high.root,
      unit(axis.shownUnit || "×"),
    );
  }

  get isChosen() {
    return this.check.checked;
  }

  read() {
    return [this.low.read(), this.high.read()];
  }
}
