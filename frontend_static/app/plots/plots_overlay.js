import { setText } from "../element.js";

const HINTS = { ready: "Press ▶ to start.", starting: "" };

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
    const sentence = snapshot ? snapshot.sentence : "Connecting to the session…";
    setText(this.box, [sentence, HINTS[snapshot?.state]].filter(Boolean).join(" "));
  }
}
