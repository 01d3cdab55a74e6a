import { element, setText } from "../element.js";
import { batchDocument } from "./batch_document.js";
import { Estimate } from "./estimate.js";
import { FieldSearch } from "./field_search.js";
import { Fold } from "./fold.js";
import { FormOptions } from "./form_options.js";
import { scenarioFields } from "./scenario_fields.js";
import { VariationRow } from "./variation_row.js";

/** Defines a batch from the present scenario: which fields vary and how, what it will take, start. */
export class BatchForm {
  #rows = [];
  #fields = [];
  #key = null; // of the batch asked for, the same when it is asked again without a change
  #isShown = false;

  /** @param {object} session @param {(document: object, key: string) => Promise<void>} start */
  constructor(session, start) {
    this.session = session;
    this.start = start;
    this.schema = null;
    this.search = new FieldSearch((field) => this.vary(field.path));
    this.list = element("ol", { class: "variations", "aria-label": "Varied fields" });
    this.intro = element("p", { class: "hint" }, "Many runs of the present scenario, with these fields varied.");
    this.empty = element("p", { class: "hint" }, "Choose a field: it gets a range, which you can change. Two fields on grids make a map.");
    this.options = new FormOptions();
    this.estimate = new Estimate();
    this.problem = element("p", { class: "form-problem", role: "status", hidden: true });
    this.button = element("button", { type: "submit", class: "start" }, "Start");
    this.body = element(
      "div",
      { id: "batch-new", class: "batch-form-body" },
      this.intro,
      this.search.root,
      element("div", { class: "batch-form-fields" }, this.empty, this.list, ...this.options.parts),
      element("div", { class: "batch-form-end" }, this.estimate.root, this.problem, element("div", { class: "form-row" }, this.button)),
    );
    this.fold = new Fold("New batch", this.body);
    this.root = element(
      "form",
      { class: "side-panel batch-form", "aria-label": "New batch", novalidate: true, submit: (event) => this.#submit(event), change: () => this.#changed(), input: () => this.#changed() },
      this.fold.root,
      this.body,
    );
    session.document.addEventListener("change", () => this.#read());
    this.#arrange();
  }

  /** Take the schema: from now on fields can be found. */
  take(schema) {
    this.schema = schema;
    this.#read();
  }

  /** An estimate is asked for only while somebody looks. */
  set isShown(isShown) {
    if (isShown === this.#isShown) return;
    this.#isShown = isShown;
    if (isShown) this.#ask();
  }

  /** Vary a field of the scenario. */
  vary(path) {
    const field = this.#fields.find((each) => each.path === path);
    if (!field || this.#rows.some((row) => row.field.path === path)) return;
    const row = new VariationRow({ ...field }, () => this.#changed(), () => this.#remove(row));
    row.showPresent(field.value);
    this.#rows.push(row);
    this.list.append(row.root);
    this.#changed();
  }

  #remove(row) {
    this.#rows = this.#rows.filter((each) => each !== row);
    row.root.remove();
    this.search.box.focus();
    this.#changed();
  }

  /** The scenario is another, or has other values: what is not there any more cannot vary. */
  #read() {
    const { beginning } = this.session.document;
    if (!beginning || !this.schema) return;
    this.#fields = scenarioFields(beginning, this.schema);
    const present = new Map(this.#fields.map(({ path, value }) => [path, value]));
    for (const row of this.#rows) if (present.has(row.field.path)) row.showPresent(present.get(row.field.path));
    this.#changed();
  }

  #changed() {
    this.#key = null;
    this.#arrange();
    this.#ask();
  }

  #arrange() {
    this.search.offer(this.#fields, new Set(this.#rows.map(({ field }) => field.path)));
    this.intro.hidden = this.empty.hidden = this.#rows.length > 0;
    this.options.arrange(this.#rows);
    const count = this.#rows.length;
    this.fold.say(count ? `${count} field${count === 1 ? "" : "s"}` : "");
    this.button.disabled = this.#rows.length === 0;
    this.#say("");
  }

  #ask() {
    if (!this.#isShown) return;
    if (!this.#rows.length || !this.session.document.beginning) return this.estimate.clear();
    try {
      this.estimate.ask(this.#document());
    } catch (problem) {
      this.estimate.refuse(problem.message);
    }
  }

  #document() {
    return batchDocument(this.session.document.beginning, this.#rows, this.options.read());
  }

  async #submit(event) {
    event.preventDefault();
    if (this.button.disabled) return;
    this.button.disabled = true;
    let sentence = "";
    try {
      this.#key ??= newKey();
      await this.start(this.#document(), this.#key);
      this.#key = null;
    } catch (refusal) {
      sentence = refusal.message;
    }
    this.button.disabled = false;
    if (sentence) (this.body.querySelector('[aria-invalid="true"]') ?? this.button).focus();
    this.#say(this.estimate.says(sentence) ? "" : sentence);
  }

  #say(sentence) {
    setText(this.problem, sentence);
    this.problem.hidden = sentence === "";
  }
}

/** A page that is not served over HTTPS has no crypto.randomUUID. */
function newKey() {
  return [...crypto.getRandomValues(new Uint32Array(4))].map((part) => part.toString(16).padStart(8, "0")).join("");
}
