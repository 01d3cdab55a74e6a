import { element } from "../element.js";
import { BatchForm } from "./batch_form.js";
import { BatchList } from "./batch_list.js";
import { BatchPage } from "./batch_page.js";
import { Batches } from "./batches.js";
import { isActive } from "./words.js";

const VIEW = "batch";
const STACKED = matchMedia("(max-width: 799px)");

/** The view Batch: what to run and the list of batches on the left, the results of one beside it; its address is #batch/<id>. */
export class BatchView {
  /** @param {HTMLElement} root @param {object} desk {session, theme, views, ask} */
  constructor(root, { session, theme, views, ask }) {
    this.views = views;
    this.schema = null;
    this.path = null; // of the batch that was shown last
    this.batches = new Batches(session);
    this.form = new BatchForm(session, (document, key) => this.#start(document, key));
    this.list = new BatchList(this.batches, ask, (id) => views.go(VIEW, id));
    this.page = new BatchPage({ session, theme, resume: (id, hear) => this.batches.resume(id, hear) });
    root.append(
      element("div", { id: "batch-side" }, this.form.root, this.list.root),
      this.page.root,
    );
    this.batches.addEventListener("list", () => this.#listed());
    this.batches.addEventListener("told", ({ detail }) => this.page.take(detail));
    views.addEventListener("change", () => this.#look());
    this.#look();
  }

  /** Take the schema: fields have names and units from now on. */
  take(schema) {
    this.schema = schema;
    this.form.take(schema);
    this.#look();
  }

  async #start(document, key) {
    const { id } = await this.batches.start(document, key);
    if (this.views.shown !== VIEW) return;
    const hasFocus = [document.body, ...this.form.body.querySelectorAll("*")].includes(document.activeElement);
    this.views.go(VIEW, id);
    if (hasFocus) this.list.focus(id); // the form that had it folds
  }

  #look() {
    const isShown = this.views.shown === VIEW;
    this.batches.isShown = isShown;
    this.form.isShown = isShown;
    if (!isShown) return;
    if (this.views.path !== this.path) this.#turn(this.views.path);
    this.list.mark(this.views.path);
    if (this.schema) this.page.open(this.views.path || null, this.schema);
  }

  /** Where there is little room, the form gives way to the list, and both to the results. */
  #turn(path) {
    this.path = path;
    this.form.fold.open(path === "");
    if (path && STACKED.matches) this.page.root.scrollIntoView({ block: "start" });
  }

  #listed() {
    const { path, shown } = this.views;
    if (shown !== VIEW || !path) return;
    const batch = this.batches.get(path);
    if (batch) return this.page.take(batch);
    if (this.page.batch?.id !== path) return;
    if (this.batches.total <= this.batches.list.length) this.views.go(VIEW, "");
    else if (isActive(this.page.batch)) this.page.look(); // it is older than those that are listed
  }
}
