import { arrange, element, setText } from "../element.js";
import { valueAt, withValues } from "../document/scenario_document.js";
import { changeableFields } from "../document/changeable_fields.js";
import { PANELS } from "../layout.js";
import { Panel } from "./panel.js";
import { PanelNote } from "./panel_note.js";
import { SequenceLine } from "./sequence_line.js";
import { entriesOf, linesOf } from "./sequence_entries.js";

const FIRST_AT_S = 5;
const FIELDS_ID = "sequence-fields";

/** Timed changes of the run: a draft that is applied as a whole, which starts the run again. */
export class SequencePanel {
  #lines = [];
  #applied = "[]";

  constructor(layout, desk) {
    this.desk = desk;
    this.panel = new Panel(layout);
    this.root = this.panel.root;
    this.empty = element("p", { class: "panel-hint" }, "No changes yet. Add one: a time, a field, and its new value.");
    this.list = element("div", { class: "sequence-lines" });
    this.fields = element("datalist", { id: FIELDS_ID });
    this.note = new PanelNote();
    this.add = element("button", { type: "button", click: () => this.#add() }, "Add a change");
    this.apply = element("button", { type: "button", click: () => this.#apply() }, "Apply");
    this.discard = element("button", { type: "button", class: "quiet", click: () => this.#discard() }, "Discard");
    this.hint = element("p", { class: "panel-note", hidden: true }, "Not applied yet. Applying restarts at t = 0.");
    const buttons = element("div", { class: "line" }, this.add, this.apply, this.discard);
    this.panel.body.append(this.empty, this.list, this.hint, buttons, this.note.root, this.fields);
    this.#arrange();
  }

  echo() {
    const scenario = this.desk.document.scenario;
    if (!scenario) return;
    const applied = JSON.stringify(scenario.sequence ?? []);
    if (applied === this.#applied) return;
    const isDraft = this.#isDraft;
    this.#applied = applied;
    if (!isDraft) this.#discard();
    this.#arrange();
  }

  /** The fields that a line may change: those of the kinds that lines before it leave in force. */
  fieldsAt(line) {
    const scenario = this.#scenarioAt(line);
    return changeableFields(PANELS, this.desk.schema, (path) => valueAt(scenario, path));
  }

  /** @returns {any} what a field would be just before a line changes it */
  valueAt(line, path) {
    return valueAt(this.#scenarioAt(line), path);
  }

  offer(line) {
    this.fields.replaceChildren(...this.fieldsAt(line).map(({ label }) => new Option("", label)));
  }

  changed() {
    this.#arrange();
  }

  remove(line) {
    this.#lines = this.#lines.filter((each) => each !== line);
    this.#arrange();
    this.add.focus();
  }

  get #isDraft() {
    return JSON.stringify(entriesOf(this.#lines.map((line) => line.value))) !== this.#applied;
  }

  /** The scenario with the kinds that all other changes up to a line's time choose. */
  #scenarioAt(line) {
    const before = this.#lines.filter((each) => each !== line && each.value.at_s <= line.value.at_s);
    const kinds = before.map(({ value }) => value).filter(({ path }) => path.endsWith(".kind"));
    const inOrder = kinds.sort((a, b) => a.at_s - b.at_s).map(({ path, value }) => [path, value]);
    return withValues(this.desk.document.beginning, Object.fromEntries(inOrder));
  }

  #add() {
    const last = this.#lines.at(-1)?.value.at_s;
    const at_s = last === undefined ? FIRST_AT_S : last + 1;
    const line = new SequenceLine(this, FIELDS_ID, { at_s, path: "", value: null });
    this.#lines.push(line);
    this.#arrange();
    line.field.focus();
  }

  #discard() {
    this.#lines = linesOf(JSON.parse(this.#applied)).map((value) => new SequenceLine(this, FIELDS_ID, value));
    this.note.say("");
    this.#arrange();
  }

  async #apply() {
    const wrong = this.#lines.find((line) => !line.check());
    if (wrong) return wrong.focus();
    const sequence = entriesOf(this.#lines.map((line) => line.value));
    if (await this.note.whileDoing(this.desk.edits.restart({ sequence }))) this.#discard();
    this.#arrange();
  }

  #arrange() {
    arrange(
      this.list,
      this.#lines.map((line) => line.root),
    );
    for (const [i, line] of this.#lines.entries()) line.number(i + 1);
    this.empty.hidden = this.#lines.length > 0;
    this.hint.hidden = this.apply.hidden = this.discard.hidden = !this.#isDraft;
    const count = JSON.parse(this.#applied).length;
    setText(this.panel.aside, count ? `${count} ${count === 1 ? "moment" : "moments"}` : "");
  }
}
