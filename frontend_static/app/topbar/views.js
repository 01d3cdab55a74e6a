/**
 * The views of the page, in the order of the navigation: each a tab in index.html and an element that it shows.
 *
 * Event `change` when another one is shown.
 */
export class Views extends EventTarget {
  constructor() {
    super();
    this.tabs = [...document.querySelectorAll('nav [role="tab"]')];
    for (const tab of this.tabs) tab.addEventListener("click", () => this.show(tab.dataset.view));
    this.show(
      this.tabs.find((tab) => `#${tab.dataset.view}` === location.hash)?.dataset.view ?? this.tabs[0].dataset.view,
    );
  }

  show(view) {
    this.shown = view;
    for (const tab of this.tabs) {
      const isShown = tab.dataset.view === view;
      tab.setAttribute("aria-selected", String(isShown));
      document.getElementById(tab.getAttribute("aria-controls")).hidden = !isShown;
      if (isShown) document.title = `VSSEA · ${tab.textContent}`;
    }
    this.dispatchEvent(new Event("change"));
  }
}
