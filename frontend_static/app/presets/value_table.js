import { element } from "../element.js";
import { wordOf } from "../parameters/choice_word.js";
import { inputText, readNumber } from "../quantity.js";

const SOURCES = ["datasheet", "measured", "identified", "estimate", "assumed"];
const PARTS = ["link", "motor", "stiffness"];
const WORDS = { link: "link", motor: "equilibrium motor", stiffness: "stiffness mechanism" };

/** Every value of an actuator, with where it comes from and how well it is known. Event `change` when one was changed. */
export class ValueTable extends EventTarget {
  constructor() {
    super();
    this.body = element("tbody");
    const heads = ["parameter", "", "value", "unit", "comes from", "±", "note"].map((text) => element("th", { scope: "col" }, text));
    this.problem = element("p", { class: "form-problem", role: "alert", hidden: true });
    this.root = element(
      "section",
      { class: "detail-section" },
      element("h3", {}, "Values"),
      element("table", { class: "value-table" }, element("thead", {}, element("tr", {}, ...heads)), this.body),
      this.problem,
    );
  }

  /** @param {object} draft content that the boxes write into @param {import("../document/parameter_schema.js").ParameterSchema} schema */
  show(draft, schema) {
    this.draft = draft;
    this.body.replaceChildren(
      ...PARTS.flatMap((part) => [
        element("tr", { class: "value-part" }, element("th", { colspan: 7, scope: "rowgroup" }, WORDS[part])),
        ...schema.names(`actuator.${part}`).map((name) => this.#row(part, schema.field(`actuator.${part}`, name))),
      ]),
    );
  }

  #row(part, field) {
    const path = `${part}.${field.name}`;
    const known = this.draft.provenance[path] ?? { source: "assumed", note: "", uncertainty: null };
    const say = (changes) => this.#changed(() => (this.draft.provenance[path] = { ...(this.draft.provenance[path] ?? known), ...changes }));
    const values = this.draft.actuator[part];
    const take = (entered) => (values[field.name] = entered);
    const value = field.choices
      ? this.#choice(field, values[field.name], take)
      : this.#number(field.title, values[field.name], field, take);
    const isNumber = !field.choices;
    const range = { low: 0, high: 1e12, unit: field.unit };
    const uncertainty = isNumber
      ? this.#number(`uncertainty of ${field.title}`, known.uncertainty, range, (number) => say({ uncertainty: number }), true)
      : "";
    if (isNumber) uncertainty.classList.add("editable");
    const source = element("select", { "aria-label": `where ${field.title} comes from`, change: () => say({ source: source.value }) }, ...SOURCES.map((word) => new Option(word)));
    source.value = known.source;
    const note = element("input", { type: "text", class: "editable", maxlength: 400, "aria-label": `note on ${field.title}`, value: known.note, change: () => say({ note: note.value.trim() }) });
    return element(
      "tr",
      { "data-path": path },
      element("th", { scope: "row", title: field.description }, field.title),
      element("td", { class: "symbol" }, field.symbol.replace("_", "")),
      element("td", {}, value),
      element("td", { class: "unit" }, field.unit),
      element("td", {}, source),
      element("td", {}, uncertainty),
      element("td", { class: "value-note" }, note),
    );
  }

  #choice({ title, choices }, shown, take) {
    const select = element("select", { "aria-label": title }, ...choices.map((each) => new Option(wordOf(each), String(each))));
    select.value = String(shown);
    select.addEventListener("change", () => this.#changed(() => take(choices.find((each) => String(each) === select.value))));
    return select;
  }

  #number(label, shown, { low, high, unit }, take, isNullable = false) {
    const box = element("input", { type: "text", class: "number", inputmode: "decimal", autocomplete: "off", "aria-label": label, value: shown === null ? "" : inputText(shown) });
    box.addEventListener("change", () => {
      const isEmpty = isNullable && box.value.trim() === "";
      const number = isEmpty ? null : readNumber(box.value);
      const isGood = isEmpty || (number >= low && number <= high);
      box.setAttribute("aria-invalid", String(!isGood));
      this.problem.hidden = isGood;
      if (isGood) this.#changed(() => take(number));
      else this.problem.textContent = `${label} is “${box.value}”; expected a number from ${inputText(low)} to ${inputText(high)} ${unit}. It is not taken over.`;
    });
    return box;
  }

  #changed(change) {
    change();
    this.dispatchEvent(new Event("change"));
  }
}
