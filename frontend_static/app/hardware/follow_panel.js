import { element, setText } from "../element.js";
import { RigPanel, panelButton } from "./rig_panel.js";
import { referenceWords } from "./reference_words.js";

/** Follow the reference that was set in Tune, or come to rest and hold. */
export class FollowPanel {
  /** @param {object} desk {session, operator, actions, views} */
  constructor({ session, operator, actions, views }) {
    Object.assign(this, { session, operator });
    this.words = element("p", { class: "rig-words" });
    this.follow = panelButton("Follow", () => this.panel.tell(actions.follow()), "Follow this reference");
    this.hold = panelButton("Hold", () => this.panel.tell(actions.hold()), "Come to rest and hold");
    this.set = panelButton("Set it in Tune", () => views.show("tune"), "The view Tune sets the reference (1)");
    this.set.classList.add("quiet");
    this.panel = new RigPanel("Follow reference", this.words, element("div", { class: "rig-row" }, this.follow, this.hold, this.set));
    this.root = this.panel.root;
    session.addEventListener("snapshot", () => this.#show());
    session.document.addEventListener("change", () => this.#show());
    operator.addEventListener("change", () => this.#show());
    this.#show();
  }

  #show() {
    const { operator, session } = this;
    const state = session.snapshot?.state;
    const mayMove = operator.isOnRig && operator.mayChange;
    const reference = session.document.value("reference");
    const isSet = reference && !(reference.kind === "jog" && !reference.velocity);
    this.follow.disabled = !mayMove || state !== "armed" || !isSet;
    this.hold.disabled = !operator.isOnRig || !session.isConnected || state !== "running"; // as safe as STOP: needs no control
    setText(this.words, referenceWords(reference));
  }
}
