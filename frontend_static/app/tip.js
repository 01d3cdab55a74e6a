import { element } from "./element.js";

const APART_PX = 14;
const EDGE_PX = 8;

/** A small floating text beside the pointer, for values in drawings. One is enough for a drawing. */
export class Tip {
  constructor() {
    this.box = element("div", { class: "tip", hidden: true });
    document.body.append(this.box);
  }

  /** Show lines at a place of the window; without lines, hide. @param {string[]} lines the first is the heading */
  show(clientX, clientY, lines) {
    this.box.hidden = lines.length === 0;
    if (!lines.length) return;
    this.box.replaceChildren(...lines.map((line) => element("p", {}, line)));
    const { offsetWidth, offsetHeight } = this.box;
    const right = clientX + APART_PX;
    const left = right + offsetWidth + EDGE_PX > innerWidth ? clientX - APART_PX - offsetWidth : right;
    this.box.style.left = `${Math.max(EDGE_PX, left)}px`;
    this.box.style.top = `${Math.max(EDGE_PX, Math.min(clientY + APART_PX, innerHeight - offsetHeight - EDGE_PX))}px`;
  }

  hide() {
    this.box.hidden = true;
  }
}
