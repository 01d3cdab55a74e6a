import { element, setText } from "../element.js";

/** What others changed meanwhile, and the choice: take theirs, or make the change on top of it. */
export class StaleNotice {
  #again = null;

  /** @param {() => void} takeTheirs shows what the server has now */
  constructor(takeTheirs) {
    this.text = element("p", {});
    this.mine = element("button", { type: "button", class: "confirm", click: () => this.#answer(() => this.#again()) }, "Save mine on top");
    this.theirs = element("button", { type: "button", click: () => this.#answer(takeTheirs) }, "Show theirs");
    this.root = element(
      "div",
      { class: "stale-notice", role: "alert", hidden: true },
      this.text,
      element("menu", {}, this.theirs, this.mine),
    );
  }

  /** Try a change; if it is refused as stale, ask, and try again on top of what there is. @returns {Promise<boolean>} whether it was kept at once */
  async attempt(change, etag, said) {
    try {
      await change(etag);
      this.root.hidden = true;
      return true;
    } catch (refusal) {
      const current = refusal.problem?.status === 412 ? refusal.problem.current : null;
      if (!current) {
        said(refusal.message);
        return false;
      }
      this.#again = () => this.attempt(change, current.etag, said);
      setText(this.text, refusal.message);
      this.root.hidden = false;
      this.mine.focus();
      return false;
    }
  }

  hide() {
    this.root.hidden = true;
  }

  #answer(then) {
    this.root.hidden = true;
    then();
  }
}
