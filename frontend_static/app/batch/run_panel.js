import { element, setText } from "../element.js";
import { CHARTS } from "../plots/chart_list.js";
import { PlotStack } from "../plots/plot_stack.js";
import { compact } from "../quantity.js";
import { rest } from "../session/rest.js";
import { batchRoutes, simulateRun } from "./batch_routes.js";
import { SimulatedRun } from "./simulated_run.js";

const SHOWN = ["position", "error", "torque"];
const STATES = { done: "done", ended: "ended early", refused: "refused", waiting: "not computed yet" };

/** The same chart where there is little room: without what is drawn faintly. */
function smaller(layout) {
  return { ...layout, id: `run-${layout.id}`, series: layout.series.filter(({ isFaint }) => !isFaint) };
}

/** One run of a batch: its values, its figures, its course simulated anew by the server, and what it is good for. */
export class RunPanel {
  #abort = null;

  /** @param {object} desk {session, theme} @param {() => void} closed */
  constructor({ session, theme }, closed) {
    this.session = session;
    this.run = null;
    this.source = new SimulatedRun(session);
    this.title = element("h2");
    this.state = element("p", { class: "run-state", role: "status" });
    this.values = element("dl", { class: "facts" });
    this.figures = element("dl", { class: "facts" });
    this.charts = element("div", { class: "recorded-charts run-charts" });
    this.note = element("p", { class: "form-hint", role: "status" });
    this.load = this.#button("Load into live session", "The live session starts again at t = 0 with this run’s scenario", () => this.#load());
    this.keep = this.#button("Keep as preset", "Saves this run’s tuning, and its scenario with it", () => this.#keep());
    this.name = element("input", { type: "text", maxlength: 80, "aria-label": "Name of the preset", autocomplete: "off", spellcheck: "false" });
    this.words = element("p", { class: "form-hint run-words", role: "status" });
    this.root = element(
      "aside",
      { id: "batch-run", class: "batch-run", "aria-label": "The chosen run", tabindex: "0", hidden: true },
      element(
        "section",
        { class: "side-panel" },
        element("div", { class: "variation-head" }, this.title, element("button", { type: "button", class: "quiet remove", "aria-label": "Close the run", title: "Close", click: closed }, "×")),
        this.state,
        this.values,
        element("div", { class: "form-row", "data-needs-control": true }, this.load),
        element("div", { class: "form-row" }, this.name, this.keep),
        this.words,
      ),
      element("section", { class: "side-panel" }, element("h2", {}, "Simulated anew"), this.note, this.charts),
      element("section", { class: "side-panel" }, element("h2", {}, "Figures"), this.figures),
    );
    const layouts = CHARTS.filter(({ id }) => SHOWN.includes(id)).map(smaller);
    this.stack = new PlotStack(this.charts, this.source, theme, layouts);
  }

  /** Show a run of a batch, or none. @param {{id: string, name: string}} batch @param {number|null} run @param {object} columns */
  async open(batch, run, columns) {
    this.#abort?.abort();
    this.run = run;
    this.batch = batch;
    this.root.hidden = run === null;
    if (run === null) return;
    const abort = (this.#abort = new AbortController());
    setText(this.title, `Run ${run}`);
    setText(this.state, "");
    this.name.value = `${batch.name} run ${run}`.slice(0, 80);
    this.#say("");
    this.#fill(this.values, []);
    this.#fill(this.figures, []);
    this.source.clear();
    this.charts.hidden = false;
    this.#can(false);
    try {
      const found = await batchRoutes.run(batch.id, run);
      if (abort.signal.aborted) return;
      this.#show(found, columns);
      if (found.state !== "refused") await this.#simulate(abort);
    } catch (refusal) {
      if (abort.signal.aborted) return;
      setText(this.note, refusal.message);
      this.charts.hidden = true;
    }
  }

  async #simulate(abort) {
    setText(this.note, "Simulating…");
    const buffer = await simulateRun(this.batch.id, this.run, abort.signal);
    if (abort.signal.aborted) return;
    this.source.open(buffer);
    this.stack.followAgain();
    setText(this.note, `${this.source.samples.time.length} samples, ${compact(this.source.lastTime)} s.`);
    this.root.dataset.simulated = String(this.run);
  }

  /** @param {object} found its values, and beside them its row of the results, as far as it is computed */
  #show(found, columns) {
    const { state, reason, values } = found;
    setText(this.state, `${STATES[state] ?? state}${reason ? `: ${reason}` : ""}`);
    this.root.dataset.state = state;
    this.#fill(this.values, Object.entries(values).map(([path, value]) => this.#line(columns, path, value)));
    this.#fill(this.figures, state === "refused" ? [] : columns.figures.filter((name) => name in found).map((name) => this.#line(columns, name, found[name])));
    this.#can(state !== "refused");
    if (state === "refused") setText(this.note, "A refused run has no course.");
  }

  #line(columns, name, value) {
    const { label } = columns.describe(name);
    return [label, columns.words(name, value, compact)];
  }

  #fill(list, lines) {
    list.replaceChildren(...lines.flatMap(([label, words]) => [element("dt", { title: label }, label), element("dd", { title: words }, words)]));
  }

  #can(isPossible) {
    this.load.disabled = this.keep.disabled = this.name.disabled = !isPossible;
  }

  async #load() {
    const scenario = await batchRoutes.scenario(this.batch.id, this.run);
    await this.session.command("load_scenario", { scenario });
    return "It runs live now, from t = 0.";
  }

  async #keep() {
    const name = this.name.value.trim();
    if (!name) {
      this.name.focus();
      return "Give the preset a name.";
    }
    const scenario = await batchRoutes.scenario(this.batch.id, this.run);
    await rest("PUT", `/api/presets/${encodeURIComponent(name)}`, { scenario }, undefined, { "If-None-Match": "*" });
    return `Kept as preset ${name}: see the view Presets.`;
  }

  #button(text, title, act) {
    const button = element("button", { type: "button", title }, text);
    button.addEventListener("click", async () => {
      const { run } = this;
      button.disabled = true;
      const words = await act().catch((refusal) => refusal.message);
      if (run !== this.run) return;
      this.#say(words);
      button.disabled = false;
    });
    return button;
  }

  #say(words) {
    setText(this.words, words);
  }
}
