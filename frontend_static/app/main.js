/** Puts the page together: one session, and the panels that show it and ask it for changes. */

import { AnalyseView } from "./analyse/analyse_view.js";
import { bindKeys } from "./keys.js";
import { ConnectionBanner } from "./connection_banner.js";
import { Baseline } from "./document/baseline.js";
import { Edits } from "./document/edits.js";
import { ParameterSchema } from "./document/parameter_schema.js";
import { EventLog } from "./foot/event_log.js";
import { LastEvent } from "./foot/last_event.js";
import { Metrics } from "./foot/metrics.js";
import { ParameterList } from "./parameters/parameter_list.js";
import { CHARTS, channelsOf } from "./plots/chart_list.js";
import { PlotStack } from "./plots/plot_stack.js";
import { PlotToolbar } from "./plots/plot_toolbar.js";
import { PlotsOverlay } from "./plots/plots_overlay.js";
import { Scene } from "./scene.js";
import { PresetsView } from "./presets/presets_view.js";
import { LiveSession } from "./session/live_session.js";
import { rest } from "./session/rest.js";
import { StabilityColumn } from "./stability/stability_column.js";
import { Theme } from "./theme.js";
import { KeysDialog } from "./topbar/keys_dialog.js";
import { LoopHealth } from "./topbar/loop_health.js";
import { ResetDialog } from "./topbar/reset_dialog.js";
import { RunControls } from "./topbar/run_controls.js";
import { StateLine } from "./topbar/state_line.js";
import { StopButton } from "./topbar/stop_button.js";
import { ThemeButton } from "./topbar/theme_button.js";
import { Views } from "./topbar/views.js";

const SCHEMA_RETRY_MS = 2000;

const theme = new Theme();
const session = new LiveSession(channelsOf(CHARTS), () => stack.timeWindow.seconds);
const views = new Views();
const stop = new StopButton(session);
const run = new RunControls(session, new ResetDialog());
const keysDialog = new KeysDialog();
const edits = new Edits(session);
const stack = new PlotStack(document.getElementById("charts"), session, theme);
const toolbar = new PlotToolbar(document.getElementById("plot-toolbar"), stack);
let parameters = null;

new ThemeButton(theme);
new StateLine(session);
new LoopHealth(session);
new ConnectionBanner(session);
new Scene(session, theme);
new PlotsOverlay(document.getElementById("plots-overlay"), session);
new LastEvent(session);
new Metrics(session);
new EventLog(session);
new StabilityColumn(document.getElementById("stability"), session);
new AnalyseView(document.getElementById("view-analyse"), { session, theme, views });
new PresetsView(document.getElementById("view-presets"), { session, views });

bindKeys({
  stop: () => stop.press(),
  pauseOrResume: () => run.pauseOrResume(),
  step: () => run.step(),
  freeze: () => toolbar.toggleFreeze(),
  cursors: () => stack.cursors.toggle(),
  undo: () => edits.undo(),
  redo: () => edits.redo(),
  savePreset: () => parameters?.presets.save(),
  viewTune: () => views.show("tune"),
  viewAnalyse: () => views.show("analyse"),
  viewPresets: () => views.show("presets"),
  showKeys: () => keysDialog.show(),
});

window.vssea = { session, store: session.store, latest: (name) => session.store.latest(name) };

session.start();
buildParameters();

async function buildParameters() {
  try {
    const { scenario } = await rest("GET", "/api/schema");
    const desk = { session, edits, schema: new ParameterSchema(scenario), baseline: new Baseline(session.document) };
    parameters = new ParameterList(document.getElementById("parameters"), desk);
  } catch (refusal) {
    session.note(`The parameters cannot be shown yet: ${refusal.message}`);
    setTimeout(buildParameters, SCHEMA_RETRY_MS);
  }
}
