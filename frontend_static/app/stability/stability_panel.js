import { element, setText } from "../element.js";

/** A titled area of the column: a list of rows, or a drawing. */
export class StabilityPanel {
  constructor(title, rows, list = "dl") {
    this.asideText = element("span", { class: "panel-aside" });
    this.noteText = element("p", { class: "stability-note", hidden: true });
    this.root = element(
      "div",
      { class: "stability-panel" },
      element("div", { class: "stability-title" }, element("h2", {}, title), this.asideText),
      element(list, { class: "stability-rows" }, ...rows),
      this.noteText,
    );
  }

  aside(text) {
    setText(this.asideText, text);
  }

  /** A sentence below the rows, one line of it; the whole on hover. */
  note(text) {
    setText(this.noteText, text);
    this.noteText.title = text;
    this.noteText.hidden = text === "";
  }
}
