import { TaskBoard } from "../analyse/task_board.js";
import { element, setText } from "../element.js";
import { channelsOf } from "../plots/chart_list.js";
import { PlotStack } from "../plots/plot_stack.js";
import { PlotToolbar } from "../plots/plot_toolbar.js";
import { rest } from "../session/rest.js";
import { chartsFor } from "./chart_choice.js";
import { Comparison } from "./comparison.js";
import { EventPanel } from "./event_panel.js";
import { ExportPanel } from "./export_panel.js";
import { FactsPanel } from "./facts_panel.js";
import { OverlayPanel, showDash, swatch } from "./overlay_panel.js";
import { RecordedRun } from "./recorded_run.js";
import { RecordingSource } from "./recording_source.js";
import { Replay } from "./replay.js";
import { ReplayBar } from "./replay_bar.js";
import { ReplayScene } from "./replay_scene.js";
import { Residual } from "./residual.js";
import { residualChart, residualChannels } from "./residual_chart.js";
import { addressOf } from "./samples.js";
import { SimulatePanel } from "./simulate_panel.js";
import { Spectra } from "./spectra.js";
import { UsePanel } from "./use_panel.js";
import { nameOf, stateWord } from "./words.js";

const GROWS_MS = 2000;
const PAGES_BY = 0.8; // of the shown span, when the replay leaves it
const SIMULATED = "-simulated";

/** One recording: its plots and replay in the middle, scene and facts on the left, comparison and uses on the right. */
export class OpenRecording {
  #timer = null;
  #result = null;
  wanted = null; // {id, span, at}: what to show once it is open

  /** @param {object} desk {session, theme} @param {() => void} back to the list */
  constructor({ session, theme }, back) {
    this.session = session;
    this.source = new RecordingSource();
    this.comparison = new Comparison(session);
    this.replay = new Replay();
    this.board = new TaskBoard();
    this.scene = new ReplayScene(theme);
    this.facts = new FactsPanel((id, changes) => this.#change(id, changes));
    this.events = new EventPanel((time) => this.#go(time));
    this.overlays = new OverlayPanel(this.comparison);
    this.simulation = new SimulatePanel(this.board, (id, result) => this.#simulated(id, result));
    this.use = new UsePanel(session, () => this.stack.timeWindow.range);
    this.export = new ExportPanel(() => (this.stack.timeWindow.isHeld ? this.stack.timeWindow.range : null));
    this.title = element("h2", { class: "recording-title" });
    this.state = element("span", { class: "recording-state" });
    this.keys = element("span", { class: "run-keys" });
    this.problem = element("p", { class: "form-problem", role: "status", hidden: true });
    this.toolbarArea = element("div", { class: "plot-toolbar", role: "toolbar", "aria-label": "Plots of the recording" });
    this.charts = element("div", { class: "recorded-charts" });
    this.empty = element("p", { class: "plots-overlay", role: "status", hidden: true });
    this.stack = new PlotStack(this.charts, this.source, theme, []);
    this.toolbar = new PlotToolbar(this.toolbarArea, this.stack);
    this.spectra = new Spectra(this, this.stack.palette, theme);
    this.spectraButton = element("button", { type: "button", class: "tool", "aria-pressed": "false", title: "Spectra of the shown span", click: () => this.#toggleSpectra() }, "Spectra");
    this.toolbarArea.insertBefore(this.spectraButton, this.toolbar.readout);
    this.toolbarArea.append(this.spectra.readout);
    this.side = element(
      "div",
      { class: "recording-side", tabindex: "0", role: "group", "aria-label": "Compare and use" },
      ...[this.overlays, this.events, this.simulation, this.use, this.export].map(({ root }) => root),
    );
    this.drawer = element("button", { type: "button", class: "drawer-handle", "aria-expanded": "false", click: () => this.#toggleDrawer() }, "Compare and use");
    this.root = element(
      "div",
      { class: "open-recording", hidden: true },
      element("div", { class: "recording-left" }, this.scene.root, this.facts.root),
      element(
        "section",
        { class: "recording-plots", "aria-label": "Plots of the recording" },
        element("div", { class: "recording-head" }, element("button", { type: "button", class: "quiet back", click: back }, "← Recordings"), this.title, this.state, this.keys, this.drawer),
        this.toolbarArea,
        element("div", { class: "recording-middle" }, this.charts, this.spectra.root, this.empty),
        new ReplayBar(this.replay).root,
      ),
      this.side,
    );
    this.replay.addEventListener("change", () => this.#moved());
    this.stack.addEventListener("pick", ({ detail }) => this.replay.seek(detail));
    this.stack.timeWindow.addEventListener("change", () => this.export.moved());
    this.comparison.addEventListener("change", () => this.#overlaid());
  }

  get isOpen() {
    return this.source.run !== null;
  }

  /** Open a recording, with others over it. */
  async open(id, overlays = []) {
    this.close();
    this.opening = id;
    this.#say("The recording is being read.");
    try {
      const facts = await rest("GET", addressOf(id));
      if (this.opening !== id) return;
      this.#show(facts);
      this.board.refresh();
      for (const other of overlays) await this.comparison.add(other).catch((refusal) => this.overlays.say(refusal.message));
    } catch (refusal) {
      if (this.opening === id) this.#say(refusal.message);
    }
  }

  close() {
    clearTimeout(this.#timer);
    this.opening = null;
    this.#result = null;
    this.replay.pause();
    this.stack.timeWindow.follow();
    this.source.open(null);
    this.comparison.open(null, []);
    this.stack.position = null;
    setText(this.title, "");
    setText(this.state, "");
  }

  /** Show the span that was asked for before this recording was open. */
  showWanted() {
    const { wanted } = this;
    if (!wanted || wanted.id !== this.source.run?.id) return;
    this.wanted = null;
    this.stack.timeWindow.zoom(...wanted.span);
    this.replay.seek(wanted.at ?? wanted.span[0]);
  }

  playOrPause() {
    this.replay.toggle();
  }

  /** One sample on. */
  step() {
    this.replay.seek(this.replay.position + this.source.run.period);
  }

  #show(facts) {
    const run = new RecordedRun(facts);
    const charts = chartsFor(run.channels);
    const channels = channelsOf(charts);
    run.need(channels);
    run.addEventListener("change", () => {
      this.#say(run.problem);
      if (!run.problem) this.#leaveOut(charts);
      if (!this.replay.isPlaying) this.#describe();
    });
    this.#say(facts.samples === 0 ? "It holds no samples." : "");
    this.source.open(run);
    this.stack.show(charts);
    this.comparison.open(facts, channels);
    this.scene.open(facts.id);
    this.use.open(facts);
    this.export.open(facts.id);
    this.simulation.open(facts);
    this.#tell(facts);
    this.replay.open(run.extent);
    this.showWanted();
    if (facts.state === "recording") this.#timer = setTimeout(() => this.#grow(), GROWS_MS);
  }

  /** An imported recording has few channels: charts without any values are left out. */
  #leaveOut(charts) {
    const { run } = this.source;
    if (run?.facts.origin !== "import" || this.stack.layouts !== charts) return;
    const picture = run.picture(run.extent, this.stack.timeWindow.pixels);
    const known = chartsFor({ has: (name) => run.channels.has(name) && picture.column(name).some((value) => !Number.isNaN(value)) });
    if (picture.time.length && known.length && known.length < charts.length) this.stack.show(known);
  }

  #tell(facts) {
    setText(this.title, nameOf(facts));
    this.title.title = nameOf(facts);
    const { text, tone } = stateWord(facts);
    setText(this.state, text);
    this.state.dataset.tone = tone;
    this.facts.show(facts);
    this.events.show(facts);
    document.title = `VSSEA · ${nameOf(facts)}`;
  }

  /** One that is still being recorded goes on while it is looked at. */
  async #grow() {
    const { run } = this.source;
    const facts = this.root.hidden ? null : await rest("GET", addressOf(run.id)).catch(() => null);
    if (this.source.run !== run) return;
    if (facts) {
      run.take(facts);
      this.comparison.facts = facts;
      this.source.readMarks();
      this.replay.grow(run.extent);
      this.#tell(facts);
    }
    if (run.facts.state === "recording") this.#timer = setTimeout(() => this.#grow(), GROWS_MS);
  }

  async #change(id, changes) {
    const recording = await rest("PATCH", addressOf(id), changes);
    const { run } = this.source;
    if (run?.id !== id) return;
    const { name, note, tags, starred, revision } = { ...changes, ...recording };
    run.take({ ...run.facts, name, note, tags, starred, revision });
    this.#tell(run.facts);
  }

  #go(time) {
    this.replay.seek(time);
    const { timeWindow } = this.stack;
    const [from, to] = timeWindow.range;
    if (time < from || time > to) timeWindow.pan(time - (from + to) / 2);
  }

  #moved() {
    const { run } = this.source;
    if (!run) return;
    const { position, isPlaying } = this.replay;
    const { timeWindow } = this.stack;
    const [from, to] = timeWindow.range;
    if (isPlaying && position > to) timeWindow.pan(position - to + PAGES_BY * (to - from));
    if (isPlaying && position < from) timeWindow.pan(position - from);
    this.stack.position = position;
    this.scene.pose(position);
    this.#describe();
  }

  #describe() {
    const { range, pixels } = this.stack.timeWindow;
    this.scene.describe(this.replay.position, this.source.picture(range, pixels));
  }

  #overlaid() {
    const { overlays } = this.comparison;
    this.source.overlays = overlays;
    this.keys.replaceChildren(...overlays.map(runKey));
    this.#residual(overlays.find(({ key }) => key === `${this.source.run?.id}${SIMULATED}`) ?? null);
    this.stack.redraw();
  }

  /** With its own simulation over it, the recording has one chart more. */
  #residual(simulation) {
    const isDrawn = this.source.derived !== null;
    if (!this.source.run || Boolean(simulation) === isDrawn) return;
    const { run } = this.source;
    const channels = residualChannels(run.channels, simulation?.run.channels);
    const charts = chartsFor(run.channels);
    this.source.derived = simulation ? new Residual(run, simulation.key, channels) : null;
    this.source.derived?.addEventListener("change", () => this.simulation.say(this.source.derived?.problem ?? ""));
    if (!simulation) this.simulation.say("");
    this.stack.show(simulation ? [...charts, residualChart(channels)] : charts);
    this.simulation.tell(simulation ? this.#result : null);
  }

  async #simulated(id, result) {
    if (this.source.run?.id !== id) return;
    this.#result = result;
    this.comparison.remove(result.recording);
    await this.comparison.add(result.recording).catch((refusal) => this.#say(refusal.message));
    this.simulation.tell(result);
  }

  #toggleSpectra() {
    const isShown = this.spectraButton.getAttribute("aria-pressed") !== "true";
    this.spectraButton.setAttribute("aria-pressed", String(isShown));
    this.charts.hidden = isShown;
    this.spectra.isShown = isShown;
  }

  #toggleDrawer() {
    const isOpen = this.root.dataset.drawer !== "open";
    this.root.dataset.drawer = isOpen ? "open" : "";
    this.drawer.setAttribute("aria-expanded", String(isOpen));
  }

  #say(text) {
    setText(this.empty, text);
    this.empty.hidden = text === "";
  }
}

function runKey(overlay) {
  const dash = swatch();
  showDash(dash, overlay.dash);
  return element("span", { class: "run-key", title: overlay.name }, dash, `${overlay.label}: ${overlay.name}`);
}
