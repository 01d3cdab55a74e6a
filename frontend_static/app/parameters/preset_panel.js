import { element, setText } from "../element.js";
import { inputText } from "../quantity.js";
import { ApplyDialog } from "../presets/apply_dialog.js";
import { StaleDialog } from "../presets/stale_dialog.js";
import { rest } from "../session/rest.js";
import { wordOf } from "./choice_word.js";
import { LinePanel } from "./panel.js";

/** Saved tunings: save, apply, archive, and what was changed since. The view Presets shows all that is known of them. */
export class PresetPanel {
  #presets = [];

  constructor(layout, desk) {
    this.desk = desk;
    this.applyDialog = new ApplyDialog();
    this.staleDialog = new StaleDialog();
    this.name = element("input", {
      type: "text",
      "aria-label": "Preset name",
      placeholder: "name of this tuning",
      maxlength: 80,
      autocomplete: "off",
      spellcheck: "false",
    });
    this.name.addEventListener("keydown", (event) => event.key === "Enter" && this.save());
    this.saveButton = element(
      "button",
      { type: "button", title: "Save the tuning in force under this name (Ctrl+S)", click: () => this.save() },
      "Save",
    );
    this.select = element("select", { "aria-label": "Saved presets" });
    this.applyButton = element("button", { type: "button", click: () => this.#apply() }, "Apply");
    this.deleteButton = element("button", { type: "button", class: "quiet", title: "Out of the list; the view Presets has it in its archive", click: () => this.#delete() }, "Archive");
    this.changes = element("p", { class: "preset-changes", hidden: true });
    this.saved = element("div", { class: "line", hidden: true }, this.select, this.applyButton, this.deleteButton);
    this.root = new LinePanel(
      layout,
      element("div", { class: "line" }, this.name, this.saveButton),
      this.saved,
      this.changes,
    ).root;
    desk.session.addEventListener("hello", () => this.#fetch());
    desk.session.addEventListener("presets", () => this.#fetch());
    this.#fetch();
  }

  echo() {
    const { preset } = this.desk.document;
    if (preset && !this.name.value && document.activeElement !== this.name) this.name.value = preset.name;
    this.#sayChanges();
  }

  /** Save under the name in the box as a new version; without a name, ask for it. */
  async save() {
    const name = this.name.value.trim();
    if (!name) return this.name.focus();
    const { preset } = this.desk.document;
    const known = preset?.name === name ? preset : this.#presets.find((line) => line.name === name);
    await this.#save(name, known?.revision);
  }

  async #save(name, revision) {
    try {
      await this.desk.session.command("save_preset", { name, ...(revision && { revision }) });
    } catch (refusal) {
      const current = refusal.problem?.status === 412 ? refusal.problem.current : null;
      if (!current) return this.desk.session.note(refusal.message);
      if (await this.staleDialog.ask(refusal.message)) return this.#save(name, current.revision);
    }
    await this.#fetch();
  }

  async #apply() {
    const name = this.select.value;
    let paths = null;
    try {
      const difference = await rest("GET", `/api/presets/${encodeURIComponent(name)}/difference`);
      if (!difference.same) paths = await this.applyDialog.ask(name, difference);
    } catch (refusal) {
      return this.desk.session.note(refusal.message);
    }
    if (paths === undefined || !(await this.#command("apply_preset", { name, ...(paths && { paths }) }))) return;
    this.name.value = name;
  }

  #delete() {
    return this.#command("delete_preset", { name: this.select.value });
  }

  async #command(command, args) {
    try {
      await this.desk.session.command(command, args);
      await this.#fetch();
      return true;
    } catch (refusal) {
      this.desk.session.note(refusal.message);
      return false;
    }
  }

  async #fetch() {
    try {
      this.#presets = await rest("GET", "/api/presets");
    } catch (refusal) {
      this.desk.session.note(refusal.message);
    }
    this.#list();
  }

  #list() {
    const chosen = this.select.value || this.desk.document.preset?.name;
    this.select.replaceChildren(...this.#presets.map(({ name }) => new Option(name, name, false, name === chosen)));
    this.saved.hidden = this.#presets.length === 0;
  }

  #sayChanges() {
    const { baseline } = this.desk;
    const changes = baseline.tuningChanges();
    this.changes.hidden = changes.length === 0;
    if (!changes.length) return;
    const count = `${changes.length} field${changes.length === 1 ? "" : "s"} changed since ${baseline.name}`;
    const which = changes.map(
      (change) => `${this.#title(change.path)} ${this.#words(change.from)} → ${this.#words(change.to)}`,
    );
    setText(this.changes, count);
    this.changes.title = which.join("\n");
    this.changes.append(element("span", { class: "preset-which" }, which.join(", ")));
  }

  #title(path) {
    const names = path.split(".");
    const name = names.pop();
    const part = names.join(".");
    if (name === "kind") return names.at(-1).replaceAll("_", " ");
    return this.desk.schema.field(part, name, this.desk.document.value(`${part}.kind`))?.title ?? name;
  }

  #words(value) {
    return typeof value === "number" ? inputText(value) : wordOf(value);
  }
}
