import { element, setText } from "../element.js";
import { sizeWords } from "../recordings/words.js";
import { batchRoutes } from "./batch_routes.js";
import { countWords, sentence, spanWords } from "./words.js";

const PATIENCE_MS = 400;
const REFUSED_SHOWN = 3;

/** What the batch that is being defined would take, as the server says: runs, time, size, which would be refused, and why. */
export class Estimate {
  #asked = 0;
  #timer = null;

  constructor() {
    this.runs = element("dd");
    this.time = element("dd");
    this.size = element("dd");
    this.problem = element("p", { class: "form-problem", hidden: true });
    this.refused = element("ul", { class: "refused-few", hidden: true });
    this.figures = element("dl", { class: "facts estimate-facts" }, element("dt", {}, "runs"), this.runs, element("dt", {}, "takes about"), this.time, element("dt", {}, "result"), this.size);
    this.root = element("div", { class: "estimate", role: "status", "aria-label": "Estimate" }, this.figures, this.problem, this.refused);
    this.clear();
  }

  clear() {
    this.#forget();
    this.#show(null, "");
  }

  /** Show why there is no estimate. */
  refuse(sentence) {
    this.#forget();
    this.#show(null, sentence);
  }

  /** @returns {boolean} whether this is what it shows */
  says(sentence) {
    return this.problem.textContent === sentence;
  }

  /** Ask the server, once nobody types. */
  ask(document) {
    this.#forget();
    const asked = this.#asked;
    this.root.classList.add("is-old");
    this.#timer = setTimeout(async () => {
      const answer = await batchRoutes.estimate(document).then((told) => [told, ""], (refusal) => [null, refusal.message]);
      if (asked === this.#asked) this.#show(...answer);
    }, PATIENCE_MS);
  }

  #forget() {
    clearTimeout(this.#timer);
    this.#asked += 1;
  }

  #show(told, problem) {
    this.root.classList.remove("is-old");
    setText(this.runs, told ? countWords(told.runs) : "–");
    setText(this.time, told ? spanWords(told.seconds) : "–");
    setText(this.size, told ? sizeWords(told.bytes) : "–");
    setText(this.problem, problem || told?.limits?.[0] || sentence(told?.warning) || refusedWords(told?.refused ?? []));
    this.problem.hidden = this.problem.textContent === "";
    this.figures.hidden = problem !== "";
    const few = (told?.refused ?? []).slice(0, REFUSED_SHOWN);
    this.refused.replaceChildren(...few.map((sentence) => element("li", {}, sentence)));
    this.refused.hidden = few.length === 0;
  }
}

function refusedWords(refused) {
  return refused.length ? "Some runs would be refused:" : "";
}
