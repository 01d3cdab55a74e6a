import { element, setText } from "../element.js";
import { compact, fixed, inputText, readNumber } from "../quantity.js";
import { CalibrationChart } from "./calibration_chart.js";

/**
 * Measured stiffness beside the model's: the table is edited, the chart and the fit are of the saved version.
 *
 * Event `change` when the draft was changed.
 */
export class CalibrationPanel extends EventTarget {
  constructor() {
    super();
    this.body = element("tbody");
    const heads = ["position", "stiffness", "model", "deviation", "note", ""];
    const units = ["rad", "N·m/rad", "N·m/rad", "%", "", ""];
    this.table = element(
      "table",
      { class: "calibration-table" },
      element("thead", {}, element("tr", {}, ...heads.map((text, i) => element("th", { scope: "col" }, text, units[i] ? element("small", {}, units[i]) : null)))),
      this.body,
    );
    this.chart = new CalibrationChart();
    this.fit = element("p", { class: "calibration-verdict" });
    this.use = element("button", { type: "button", hidden: true, click: () => this.#use() }, "Use it as spring constant");
    this.empty = element("p", { class: "hint" }, "No points yet. Measure the stiffness of the unloaded spring at some positions of the stiffness motor, and add them.");
    this.add = element("button", { type: "button", click: () => this.#add() }, "Add a point");
    this.root = element(
      "section",
      { class: "detail-section" },
      element("h3", {}, "Calibration"),
      this.empty,
      element("div", { class: "calibration-area" }, element("div", {}, this.table, this.add), this.chart.root),
      element("div", { class: "form-row" }, this.fit, this.use),
    );
  }

  /** @param {object} draft content that the boxes write into @param {object|null} report of the saved version */
  show(draft, report) {
    this.draft = draft;
    if (report) this.report = report;
    this.#rows();
    this.chart.show(this.report ?? { rows: [] });
    const fit = this.report?.fit;
    const now = this.report?.rms_percent;
    setText(this.fit, fit ? `Yτ = ${inputText(Number(fit.spring_constant.toPrecision(4)))} N·m·rad³ fits best: ${compact(fit.rms_percent)} % RMS, now ${compact(now)} %.` : "");
    this.use.hidden = !fit || Math.abs(fit.spring_constant / draft.actuator.stiffness.spring_constant - 1) < 1e-4;
  }

  #rows() {
    const points = this.draft.calibration;
    this.empty.hidden = points.length > 0;
    this.table.hidden = points.length === 0;
    this.body.replaceChildren(...points.map((point, i) => this.#row(point, i)));
  }

  #row(point, i) {
    const model = this.draft.actuator.stiffness.spring_constant / (2 * point.stiffness_motor_position ** 3);
    const off = 100 * (point.stiffness / model - 1);
    const set = (name, value) => {
      this.draft.calibration[i] = { ...point, [name]: value };
      this.#changed();
    };
    const number = (name, label) => {
      const box = element("input", { type: "text", class: "number", inputmode: "decimal", autocomplete: "off", "aria-label": `${label} of point ${i + 1}`, value: point[name] ? inputText(point[name]) : "" });
      box.addEventListener("change", () => {
        const value = readNumber(box.value);
        box.setAttribute("aria-invalid", String(!(value > 0)));
        if (value > 0) set(name, value);
      });
      return box;
    };
    const note = element("input", { type: "text", class: "editable", maxlength: 400, "aria-label": `note on point ${i + 1}`, value: point.note, change: () => set("note", note.value.trim()) });
    const remove = () => {
      this.draft.calibration.splice(i, 1);
      this.#changed();
    };
    return element(
      "tr",
      {},
      element("td", {}, number("stiffness_motor_position", "position")),
      element("td", {}, number("stiffness", "stiffness")),
      element("td", { class: "figure" }, point.stiffness_motor_position ? compact(model) : "–"),
      element("td", { class: "figure" }, point.stiffness ? fixed(off, 1) : "–"),
      element("td", { class: "value-note" }, note),
      element("td", {}, element("button", { type: "button", class: "quiet", "aria-label": `Remove point ${i + 1}`, click: remove }, "×")),
    );
  }

  #add() {
    const { spring_constant: constant, softest, stiffest } = this.draft.actuator.stiffness;
    const middle = Math.sqrt(softest * stiffest);
    const position = Number(Math.cbrt(constant / (2 * middle)).toPrecision(4));
    this.draft.calibration.push({ stiffness_motor_position: position, stiffness: Number((constant / (2 * position ** 3)).toPrecision(4)), note: "" });
    this.#changed();
    this.body.lastElementChild.querySelector("input").select();
  }

  #use() {
    this.draft.actuator.stiffness.spring_constant = Number(this.report.fit.spring_constant.toPrecision(6));
    const known = this.draft.provenance["stiffness.spring_constant"];
    this.draft.provenance["stiffness.spring_constant"] = { uncertainty: null, ...known, source: "identified", note: `fitted to ${this.report.rows.length} calibration points` };
    this.use.hidden = true;
    this.#changed();
    this.dispatchEvent(new Event("values"));
  }

  #changed() {
    this.#rows();
    this.dispatchEvent(new Event("change"));
  }
}
