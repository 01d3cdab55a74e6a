import { setText } from "../element.js";

/** What the plots say while there is nothing to plot. */
export class PlotsOverlay {
  constructor(root, session) {
    this.session = session;
    this.box = root;
    for (const type of ["snapshot", "connection"]) session.addEventListener(type, () => this.#show());
    this.#show();
  }

  #show() {
    const { snapshot, store, isConnected } = this.session;
    const isWanted = !snapshot || snapshot.state === "starting" || store.length === 0;
    this.box.hidden = !isWanted || (!isConnected && snapshot !== null);
    if (!isWanted) return;
    setText(this.box, snapshot ? snapshot.sentence : "Connecting to the session…");
  }
}
