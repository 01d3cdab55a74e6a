import { element, setText } from "../element.js";

/**
 * A form in the left column that starts one kind of task: its fields, a start button, and why a request was refused.
 */
export class TaskForm {
  /** @param {string} title @param {HTMLElement[]} fields @param {string} start words of the button
   *  @param {() => Promise<void>} ask may throw a sentence */
  constructor(title, fields, start, ask) {
    this.problem = element("p", { class: "form-problem", role: "status", hidden: true });
    this.button = element("button", { type: "submit", class: "start" }, start);
    this.root = element(
      "form",
      { class: "side-panel", "aria-label": title, novalidate: true, submit: (event) => this.#submit(event, ask) },
      element("h2", {}, title),
      ...fields,
      this.problem,
      element("div", { class: "form-row" }, this.button),
    );
  }

  async #submit(event, ask) {
    event.preventDefault();
    this.button.disabled = true;
    let sentence = "";
    try {
      await ask();
    } catch (refusal) {
      sentence = refusal.message;
    }
    this.button.disabled = false;
    setText(this.problem, sentence);
    this.problem.hidden = sentence === "";
  }
}
