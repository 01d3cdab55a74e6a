import { element } from "../element.js";
import { ActuatorDetail } from "./actuator_detail.js";
import { DocumentList } from "./document_list.js";
import { ImportPanel } from "./import_panel.js";
import { Library } from "./library.js";
import { PresetDetail } from "./preset_detail.js";
import { SavePanel } from "./save_panel.js";

const SECTIONS = [
  {
    kind: "presets",
    title: "Presets",
    what: "what runs",
    Detail: PresetDetail,
    empty: "No presets yet. Tune in the view Tune (key 1) and save there with Ctrl+S, or save what runs below.",
    hint: "Choose a preset on the left to see what applying it would change, its versions and its note.",
  },
  {
    kind: "actuators",
    title: "Actuators",
    what: "the plant that runs",
    Detail: ActuatorDetail,
    empty: "No actuators yet. Save the plant that runs below, then enter what you know of the real one.",
    hint: "Choose an actuator on the left to see its values, where each comes from, and its calibration.",
  },
];

/** The view Presets: the library on the left, the chosen document on the right. */
export class PresetsView {
  constructor(root, { session, views }) {
    this.views = views;
    this.sections = SECTIONS.map((each) => this.#section(each, session));
    this.main = element("div", { id: "presets-main", tabindex: "0", role: "group", "aria-label": "The chosen document" });
    root.append(
      element(
        "div",
        { id: "presets-side", tabindex: "0", role: "group", "aria-label": "Library" },
        element("nav", { class: "section-list", "aria-label": "Libraries" }, ...this.sections.map(({ button }) => button)),
        ...this.sections.map(({ side }) => side),
      ),
      this.main,
    );
    this.main.append(...this.sections.flatMap(({ detail, hint }) => [detail.root, hint]));
    for (const event of ["hello", "presets"]) session.addEventListener(event, () => this.#refresh());
    views.addEventListener("change", () => this.#refresh());
    this.show("presets");
  }

  /** Show one library. */
  show(kind) {
    this.shown = this.sections.find((section) => section.kind === kind);
    for (const section of this.sections) this.#arrange(section);
    this.#refresh();
  }

  #section({ kind, title, what, Detail, empty, hint }, session) {
    const library = new Library(kind, session);
    const section = {
      kind,
      library,
      button: element("button", { type: "button", class: "section-button", "data-section": kind, click: () => this.show(kind) }, title),
      detail: new Detail(library, session),
      hint: element("p", { class: "result-overlay" }, hint),
      side: element("div", {}, new DocumentList(library, empty).root, new SavePanel(library, what).root, new ImportPanel(library).root),
    };
    library.addEventListener("chosen", () => {
      this.#arrange(section);
      if (library.chosen) section.detail.show(library.chosen);
    });
    return section;
  }

  #arrange(section) {
    const isShown = section === this.shown;
    if (isShown) section.button.setAttribute("aria-current", "true");
    else section.button.removeAttribute("aria-current");
    section.side.hidden = !isShown;
    section.detail.root.hidden = !isShown || !section.library.chosen;
    section.hint.hidden = !isShown || Boolean(section.library.chosen);
  }

  #refresh() {
    if (this.views.shown !== "presets" || !this.shown) return;
    this.shown.library.refresh();
    if (this.shown.library.chosen) this.shown.detail.look();
  }
}
