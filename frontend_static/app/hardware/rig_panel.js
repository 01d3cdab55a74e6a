import { element, setText } from "../element.js";

/** A titled area of the view Hardware: a word beside its title, its controls, and a place for what was refused. */
export class RigPanel {
  constructor(title, ...children) {
    this.aside = element("span", { class: "rig-panel-aside" });
    this.note = element("p", { class: "rig-note", role: "status", hidden: true });
    this.root = element(
      "section",
      { class: "rig-panel", "aria-label": title },
      element("h2", {}, title, this.aside),
      ...children,
      this.note,
    );
  }

  /** A sentence beneath the controls; "" removes it. @param {"info"|"warning"} tone */
  say(text, tone = "warning") {
    setText(this.note, text);
    this.note.dataset.tone = tone;
    this.note.hidden = text === "";
  }

  /** Show what became of something asked for: nothing, or why it was refused. @returns {Promise<boolean>} whether it was done */
  async tell(answer) {
    this.say("");
    try {
      await answer;
      return true;
    } catch (refusal) {
      this.say(refusal.message);
      return false;
    }
  }
}

/** A button of a panel. */
export function panelButton(text, click, title = "") {
  return element("button", { type: "button", title, click }, text);
}
