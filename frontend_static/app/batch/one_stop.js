/** Makes a list one stop of the Tab key, however long it is: arrow keys go from line to line, Tab through the buttons of that one. */
export class OneStop {
  #at = null;

  /** @param {HTMLElement} list its children are the lines, their first button is what they are about */
  constructor(list) {
    this.list = list;
    list.addEventListener("focusin", (event) => this.#stop([...list.children].find((line) => line.contains(event.target))));
    list.addEventListener("keydown", (event) => this.#move(event));
  }

  /** The lines are others, or another one is preferred. @param {HTMLElement|null} preferred */
  arrange(preferred) {
    const lines = [...this.list.children];
    const isKept = lines.includes(this.#at) && (!preferred || this.list.contains(document.activeElement));
    this.#stop(isKept ? this.#at : (preferred ?? lines[0] ?? null));
  }

  #move(event) {
    const lines = [...this.list.children];
    const at = lines.indexOf(this.#at);
    const to = { ArrowUp: at - 1, ArrowDown: at + 1, Home: 0, End: lines.length - 1 }[event.key];
    if (to === undefined) return;
    event.preventDefault();
    lines[to]?.querySelector("button").focus();
  }

  #stop(stop) {
    this.#at = stop;
    for (const line of this.list.children) for (const button of line.querySelectorAll("button")) button.tabIndex = line === stop ? 0 : -1;
  }
}
