/**
 * The views of the page, in the order of the navigation: each a tab in index.html and an element that it shows. The address
 * says which is shown, and what in it: #view/path.
 *
 * Event `change` when another one, or something else in it, is shown.
 */
export class Views extends EventTarget {
  #paths = new Map();

  constructor() {
    super();
    this.tabs = [...document.querySelectorAll('nav [role="tab"]')];
    for (const tab of this.tabs)
      tab.addEventListener("click", () => (tab.dataset.view === this.shown ? this.go(this.shown, "") : this.show(tab.dataset.view)));
    addEventListener("hashchange", () => this.#read());
    addEventListener("popstate", () => this.#read());
    this.#read();
    new ResizeObserver(() => this.#reveal()).observe(document.querySelector("nav"));
  }

  /** What is open in the shown view, "" for nothing. */
  get path() {
    return this.#paths.get(this.shown) ?? "";
  }

  /** Show a view as it was left. */
  show(view) {
    this.go(view, this.#paths.get(view) ?? "");
  }

  /** Show a view with something open in it; the browser's way back leads to what was shown before. */
  go(view, path) {
    const address = path ? `#${view}/${encodeURIComponent(path)}` : `#${view}`;
    if (location.hash !== address) history.pushState(null, "", address);
    this.#paths.set(view, path);
    this.#mark(view);
  }

  #read() {
    const [view, path] = location.hash.slice(1).split("/");
    const known = this.tabs.some((tab) => tab.dataset.view === view);
    if (known) this.#paths.set(view, decoded(path ?? ""));
    this.#mark(known ? view : this.tabs[0].dataset.view);
  }

  #mark(view) {
    this.shown = view;
    for (const tab of this.tabs) {
      const isShown = tab.dataset.view === view;
      tab.setAttribute("aria-selected", String(isShown));
      document.getElementById(tab.getAttribute("aria-controls")).hidden = !isShown;
      if (isShown) document.title = `VSSEA · ${tab.textContent}`;
    }
    this.#reveal();
    this.dispatchEvent(new Event("change"));
  }

  /** Where the tabs do not all fit, the chosen one is in sight. */
  #reveal() {
    this.tabs.find((tab) => tab.dataset.view === this.shown)?.scrollIntoView({ block: "nearest", inline: "nearest" });
  }
}

function decoded(path) {
  try {
    return decodeURIComponent(path);
  } catch {
    return path; // typed by hand
  }
}
