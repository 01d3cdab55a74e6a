import { element } from "../element.js";
import { addressOf } from "./samples.js";

const FORMS = [
  ["csv", "CSV"],
  ["parquet", "Parquet"],
  ["json", "JSON summary"],
  ["mcap", "MCAP"],
];
const WHOLE = "mcap"; // the recording's own file
const WHOLE_WORDS = "The recording’s own file, always the whole of it";

/** Plain links to the recording as a file, whole or the shown span, and to its report. */
export class ExportPanel {
  /** @param {() => [number, number]|null} shown span, null if all of it is shown */
  constructor(shown) {
    this.shown = shown;
    this.links = FORMS.map(([form, title]) => ({ form, link: element("a", { class: "export-link", download: true }, title) }));
    this.span = element(
      "select",
      { "aria-label": "Which part", change: () => this.#point() },
      new Option("whole", "whole"),
      new Option("shown span", "shown"),
    );
    this.links.find(({ form }) => form === WHOLE).link.title = WHOLE_WORDS;
    this.report = element("a", { target: "_blank", rel: "noopener" }, "Report");
    this.reportFile = element("a", { download: true }, "as a file");
    this.root = element(
      "section",
      { class: "side-panel", "aria-label": "Export" },
      element("h2", {}, "Export"),
      element("div", { class: "form-row" }, this.span, ...this.links.slice(0, 2).map(({ link }) => link)),
      element("div", { class: "form-row" }, ...this.links.slice(2).map(({ link }) => link)),
      element("div", { class: "form-row" }, this.report, this.reportFile),
    );
  }

  open(id) {
    this.id = id;
    this.#point();
  }

  /** Another span is shown. */
  moved() {
    if (this.span.value === "shown") this.#point();
  }

  #point() {
    const part = this.span.value === "shown" ? this.shown() : null;
    const query = part ? { from_s: part[0].toFixed(4), to_s: part[1].toFixed(4) } : {};
    for (const { form, link } of this.links)
      link.href = addressOf(this.id, "export", form === WHOLE ? { form } : { form, ...query });
    this.report.href = this.reportFile.href = addressOf(this.id, "report");
    this.reportFile.download = `${this.id}.html`;
  }
}
