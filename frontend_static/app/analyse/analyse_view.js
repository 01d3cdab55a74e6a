import { element } from "../element.js";
import { Palette } from "../plots/palette.js";
import { loadAxes } from "./axes.js";
import { BandwidthForm } from "./bandwidth_form.js";
import { BandwidthSection } from "./bandwidth_section.js";
import { LoopAnalysis } from "./loop_analysis.js";
import { LoopSection } from "./loop_section.js";
import { MapForm } from "./map_form.js";
import { MapSection } from "./map_section.js";
import { PaperSection, reportAddress } from "./paper_section.js";
import { Subject } from "./subject.js";
import { SubjectPanel } from "./subject_panel.js";
import { TaskBoard } from "./task_board.js";
import { TaskList } from "./task_list.js";
import { WorstCaseForm } from "./worst_case_form.js";
import { WorstCaseSection } from "./worst_case_section.js";

const SECTIONS = [
  { id: "loop", title: "Loop" },
  { id: "map", title: "Map" },
  { id: "bandwidth", title: "Bandwidths" },
  { id: "worst", title: "Worst case" },
  { id: "paper", title: "The paper" },
];
const SECTION_OF = {
  stability_map: "map",
  margin_map: "map",
  bandwidth_sets: "bandwidth",
  worst_case: "worst",
  paper: "paper",
};

/** The view Analyse: what is analysed and how on the left, the chosen section's results on the right. */
export class AnalyseView {
  constructor(root, { session, theme, views }) {
    this.session = session;
    this.theme = theme;
    this.views = views;
    this.palette = new Palette(theme);
    this.subject = new Subject(session.document);
    this.analysis = new LoopAnalysis(session, this.subject);
    this.board = new TaskBoard();
    this.panel = new SubjectPanel(this.subject, this.analysis);
    this.tasks = new TaskList(
      this.board,
      (task) => (task.kind === "paper" ? reportAddress(task) : null),
      (task) => task.kind in SECTION_OF,
    );
    this.sections = new Map([["loop", { main: new LoopSection(this.analysis, this.palette, theme) }]]);
    this.buttons = SECTIONS.map(({ id, title }) =>
      element("button", { type: "button", class: "section-button", "data-section": id, click: () => this.show(id) }, title),
    );
    this.forms = element("div");
    this.main = element("div", { id: "analyse-main" });
    root.append(
      element(
        "div",
        { id: "analyse-side", tabindex: "0", role: "group", "aria-label": "What is analysed and how" },
        element("nav", { class: "section-list", "aria-label": "Analyses" }, ...this.buttons),
        this.panel.root,
        this.forms,
        this.tasks.root,
      ),
      this.main,
    );
    this.main.append(this.sections.get("loop").main.root);
    this.board.addEventListener("result", ({ detail }) => this.#take(detail));
    views.addEventListener("change", () => this.#look());
    this.show("loop");
    this.#build();
  }

  /** Show one section. */
  show(id) {
    this.shown = id;
    for (const button of this.buttons) {
      if (button.dataset.section === id) button.setAttribute("aria-current", "true");
      else button.removeAttribute("aria-current");
    }
    for (const [name, { main, form }] of this.sections) {
      main.root.hidden = name !== id;
      if (form) form.root.hidden = name !== id;
    }
    this.panel.root.hidden = id === "paper";
    this.panel.showFor(id);
    this.#look();
  }

  /** The sections that need the list of axes. */
  async #build() {
    let axes;
    try {
      axes = await loadAxes();
    } catch (refusal) {
      return this.session.note(`Maps cannot be shown: ${refusal.message} Reload the page.`);
    }
    const { subject, board, palette, theme } = this;
    const map = new MapSection(axes, palette, theme);
    this.sections.set("map", { main: map, form: new MapForm(axes, subject, board, (layer) => map.show(layer)) });
    this.sections.set("bandwidth", {
      main: new BandwidthSection(this.session.document),
      form: new BandwidthForm(subject, board),
    });
    this.sections.set("worst", { main: new WorstCaseSection(axes), form: new WorstCaseForm(axes, subject, board) });
    this.sections.set("paper", { main: new PaperSection(board) });
    for (const [name, { main, form }] of this.sections) {
      if (name !== "loop") this.main.append(main.root);
      if (form) this.forms.append(form.root);
    }
    this.show(this.shown);
  }

  /** Show a result in its section. */
  #take({ task, asked, result }) {
    const id = SECTION_OF[task.kind];
    if (!id) return;
    this.sections.get(id)?.main.take?.(result, asked, this.session.document.scenario);
    if (id !== "paper") this.show(id);
  }

  #look() {
    const isShown = this.views.shown === "analyse";
    this.analysis.show(isShown && this.shown === "loop");
    if (isShown) this.board.refresh();
  }
}
