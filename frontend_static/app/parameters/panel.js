import { element } from "../element.js";

const KEY = "vssea.collapsed";

/** A short area of a title and lines of controls beside it. */
export class LinePanel {
  constructor({ id, title }, ...lines) {
    this.root = element("div", { class: "line-panel", id: `panel-${id}` }, element("h2", {}, title), ...lines);
  }
}

/** A titled, collapsible area of the parameter column. */
export class Panel {
  constructor({ id, title, hint, isCollapsed = false }) {
    this.aside = element("span", { class: "panel-aside" });
    this.body = element("div", { class: "panel-body" }, hint ? element("p", { class: "panel-hint" }, hint) : null);
    const remembered = JSON.parse(localStorage.getItem(KEY) ?? "{}");
    this.root = element(
      "details",
      { class: "panel", id: `panel-${id}`, open: !(remembered[id] ?? isCollapsed) },
      element("summary", {}, element("h2", {}, title), this.aside),
      this.body,
    );
    this.root.addEventListener("toggle", () => {
      const all = JSON.parse(localStorage.getItem(KEY) ?? "{}");
      localStorage.setItem(KEY, JSON.stringify({ ...all, [id]: !this.root.open }));
    });
  }
}
