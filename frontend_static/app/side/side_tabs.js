import { element } from "../element.js";

const KEY = "vssea.side";

/** The right column of Tune below its sentence: one of some panels at a time, chosen by tabs. */
export class SideTabs {
  #tabs = new Map();

  /** @param {HTMLElement} root the column @param {{id: string, title: string, body: HTMLElement}[]} panels */
  constructor(root, panels) {
    const bar = element("div", { class: "side-tabs", role: "tablist", "aria-label": "Beside the plots" });
    const side = element("div", { id: "side" }, bar);
    for (const { id, title, body } of panels) {
      const tab = element(
        "button",
        { type: "button", role: "tab", id: `side-tab-${id}`, "aria-controls": `side-${id}`, click: () => this.show(id) },
        title,
      );
      const panel = element(
        "div",
        { class: "side-tab-panel", id: `side-${id}`, role: "tabpanel", "aria-labelledby": tab.id, tabindex: "0" },
        body,
      );
      this.#tabs.set(id, { tab, panel, title });
      bar.append(tab);
      side.append(panel);
    }
    bar.addEventListener("keydown", (event) => this.#step(event));
    root.append(side);
    const saved = localStorage.getItem(KEY);
    this.show(this.#tabs.has(saved) ? saved : panels[0].id);
  }

  show(id) {
    localStorage.setItem(KEY, id);
    for (const [each, { tab, panel }] of this.#tabs) {
      tab.setAttribute("aria-selected", String(each === id));
      tab.tabIndex = each === id ? 0 : -1;
      panel.hidden = each !== id;
    }
  }

  /** Say how much there is behind a tab. @param {number} count 0 says nothing */
  count(id, count) {
    const { tab, title } = this.#tabs.get(id);
    tab.textContent = count ? `${title} ${count}` : title;
  }

  #step(event) {
    const way = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!way) return;
    const ids = [...this.#tabs.keys()];
    const from = ids.findIndex((id) => this.#tabs.get(id).tab === document.activeElement);
    const to = ids[(from + way + ids.length) % ids.length];
    this.show(to);
    this.#tabs.get(to).tab.focus();
  }
}
