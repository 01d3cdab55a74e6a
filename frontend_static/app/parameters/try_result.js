import { element, setText } from "../element.js";
import { displayUnit, inputText, significant } from "../quantity.js";
import { wordOf } from "./choice_word.js";

const SHOWN = ["peak_error", "rms_error", "peak_torque", "torque_chatter", "saturated"];

/** What the simulation says of a change that is not yet on the rig, with Apply and Discard. */
export class TryResult {
  /** @param {object} desk {session, operator, tryFirst} */
  constructor({ session, operator, tryFirst }) {
    Object.assign(this, { session, operator, tryFirst });
    this.changes = element("p", { class: "try-changes" });
    this.words = element("p", { class: "try-words", role: "status" });
    this.figures = element("dl", { class: "try-figures" });
    this.apply = element("button", { type: "button", class: "start", click: () => this.#apply() }, "Apply to the rig");
    this.discard = element("button", { type: "button", click: () => tryFirst.discard() }, "Discard");
    this.root = element(
      "section",
      { class: "try-result", "aria-label": "Tried in simulation", hidden: true },
      this.changes,
      this.words,
      this.figures,
      element("div", { class: "rig-row" }, this.apply, this.discard),
    );
    for (const source of [tryFirst, operator]) source.addEventListener("change", () => this.#show());
    this.#show();
  }

  #show() {
    const { changes, result, problem, isBusy } = this.tryFirst;
    this.root.hidden = changes === null;
    if (changes === null) return;
    setText(this.changes, `Not on the rig yet: ${this.#changesWords(changes)}`);
    this.changes.title = this.changes.textContent;
    setText(this.words, isBusy ? "Simulating…" : problem || (result?.ok === false ? result.sentence : "In simulation it does well."));
    this.words.classList.toggle("is-warning", Boolean(problem) || result?.ok === false);
    this.words.hidden = this.words.textContent === "";
    this.apply.disabled = isBusy || problem !== "" || !this.operator.mayChange;
    this.#showFigures(result);
  }

  /** Its metrics are {name: [of the present tuning, of this one]}; names and units are those of the live figures. */
  #showFigures(result) {
    const known = this.session.snapshot?.metrics?.items ?? [];
    const shown = SHOWN.map((name) => known.find((item) => item.name === name)).filter((item) => item && result?.metrics?.[item.name]);
    this.figures.hidden = shown.length === 0;
    this.figures.replaceChildren(
      ...shown.flatMap(({ name, label, unit }) => {
        const { unit: word, factor } = displayUnit(unit);
        const [now, then] = result.metrics[name].map((value) => significant(value === null ? null : value * factor));
        return [element("dt", {}, label), element("dd", {}, `${now} → `, element("strong", {}, then), element("small", {}, ` ${word}`))];
      }),
    );
  }

  #changesWords(changes) {
    const said = Object.entries(changes).map(([path, value]) => {
      const name = path.split(".").filter((part) => part !== "kind").join(" ");
      const before = this.session.document.value(`tuning.${path}`);
      return `${name.replaceAll("_", " ")} ${worded(before)} → ${worded(value)}`;
    });
    return said.join(", ");
  }

  async #apply() {
    this.apply.disabled = true;
    await this.tryFirst.apply().catch((refusal) => setText(this.words, refusal.message));
    this.words.hidden = this.words.textContent === "";
    this.apply.disabled = false;
  }
}

function worded(value) {
  return typeof value === "number" ? inputText(value) : wordOf(value ?? "none");
}
