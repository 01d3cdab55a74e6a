/** Puts the page together: one session, and the panels that show it and ask it for changes. */

import { AnalyseView } from "./analyse/analyse_view.js";
import { BatchView } from "./batch/batch_view.js";
import { bindKeys } from "./keys.js";
import { ConnectionBanner } from "./connection_banner.js";
import { Baseline } from "./document/baseline.js";
import { Edits } from "./document/edits.js";
import { ParameterSchema } from "./document/parameter_schema.js";
import { EventLog } from "./foot/event_log.js";
import { LastEvent } from "./foot/last_event.js";
import { Metrics } from "./foot/metrics.js";
import { MORE_CHANNELS } from "./hardware/hardware_charts.js";
import { HardwareView } from "./hardware/hardware_view.js";
import { RigActions } from "./hardware/rig_actions.js";
import { ChangeHistory } from "./history/change_history.js";
import { HistoryPanel } from "./history/history_panel.js";
import { ParameterList } from "./parameters/parameter_list.js";
import { Ghosts } from "./pins/ghosts.js";
import { PinPanel } from "./pins/pin_panel.js";
import { PinnedRuns } from "./pins/pinned_runs.js";
import { CHARTS, channelsOf } from "./plots/chart_list.js";
import { LiveSource } from "./plots/live_source.js";
import { PlotStack } from "./plots/plot_stack.js";
import { PlotToolbar } from "./plots/plot_toolbar.js";
import { PlotsOverlay } from "./plots/plots_overlay.js";
import { AskDialog } from "./recordings/ask_dialog.js";
import { RecordingsView } from "./recordings/recordings_view.js";
import { Scene } from "./scene.js";
import { PresetsView } from "./presets/presets_view.js";
import { Jog } from "./session/jog.js";
import { LiveSession } from "./session/live_session.js";
import { Operator } from "./session/operator.js";
import { rest } from "./session/rest.js";
import { TryFirst } from "./session/try_first.js";
import { SideTabs } from "./side/side_tabs.js";
import { StabilityColumn } from "./stability/stability_column.js";
import { Theme } from "./theme.js";
import { ControlMenu } from "./topbar/control_menu.js";
import { ControlStrip } from "./topbar/control_strip.js";
import { KeysDialog } from "./topbar/keys_dialog.js";
import { LoopHealth } from "./topbar/loop_health.js";
import { RigMark } from "./topbar/rig_mark.js";
import { ResetDialog } from "./topbar/reset_dialog.js";
import { RunControls } from "./topbar/run_controls.js";
import { StateLine } from "./topbar/state_line.js";
import { StopButton } from "./topbar/stop_button.js";
import { ThemeButton } from "./topbar/theme_button.js";
import { Trigger } from "./trigger/trigger.js";
import { TriggerTool } from "./trigger/trigger_tool.js";
import { Views } from "./topbar/views.js";

const SCHEMA_RETRY_MS = 2000;

const theme = new Theme();
const session = new LiveSession([...channelsOf(CHARTS), ...MORE_CHANNELS], () => stack.timeWindow.seconds);
const operator = new Operator(session);
const jog = new Jog(operator);
const tryFirst = new TryFirst(operator);
const resetDialog = new ResetDialog();
const ask = new AskDialog();
const views = new Views();
const stop = new StopButton(session, jog);
const run = new RunControls(operator, resetDialog);
const keysDialog = new KeysDialog();
const edits = new Edits(session, tryFirst);
const history = new ChangeHistory(operator);
const stack = new PlotStack(document.getElementById("charts"), new LiveSource(session), theme);
const pins = new PinnedRuns(session, channelsOf(CHARTS));
const pinWindow = () => views.shown === "tune" && pins.pin(stack.timeWindow.range, !stack.timeWindow.isHeld);
stack.source.ghosts = new Ghosts(pins, stack.timeWindow);
const toolbar = new PlotToolbar(document.getElementById("plot-toolbar"), stack);
const trigger = new Trigger(session);
let parameters = null;

new TriggerTool(document.getElementById("plot-toolbar"), trigger);
trigger.addEventListener("captured", ({ detail }) => showCaptured(detail));
new ThemeButton(theme);
new StateLine(session);
new RigMark(session);
new ControlMenu(operator);
new ControlStrip(operator, views);
new LoopHealth(session);
new ConnectionBanner(session);
new Scene(session, theme);
new PlotsOverlay(document.getElementById("plots-overlay"), session);
new LastEvent(session);
new Metrics(session);
new EventLog(session);
const margins = new StabilityColumn(document.getElementById("stability"), session);
const side = new SideTabs(document.getElementById("stability"), [
  { id: "margins", title: "Margins", body: margins.body },
  { id: "history", title: "History", body: new HistoryPanel(history).root },
  { id: "pins", title: "Pinned", body: new PinPanel(pins, pinWindow).root },
]);
new AnalyseView(document.getElementById("view-analyse"), { session, theme, views });
const batch = new BatchView(document.getElementById("view-batch"), { session, theme, views, ask });
new PresetsView(document.getElementById("view-presets"), { session, views });

const recordings = new RecordingsView(document.getElementById("view-recordings"), { session, theme, views });

const hardware = new HardwareView(document.getElementById("view-hardware"), {
  session,
  operator,
  jog,
  tryFirst,
  theme,
  views,
  pins,
  ask,
  actions: new RigActions(operator, { ask, reset: resetDialog }),
  openRecording: (id, span, at) => recordings.openSpan(id, span, at),
});

bindKeys({
  stop: () => stop.press(),
  pauseOrResume: () => recordings.takeSpace() || run.pauseOrResume(),
  step: () => (recordings.isOpen ? recordings.page.step() : run.step()),
  freeze: () => (hardware.isShown ? hardware.toolbar : toolbar).toggleFreeze(),
  cursors: () => (recordings.isOpen ? recordings.page.stack : hardware.isShown ? hardware.stack : stack).cursors.toggle(),
  pin: () => pinWindow(),
  undo: () => history.undo(),
  redo: () => history.redo(),
  savePreset: () => parameters?.presets.save(),
  viewTune: () => views.show("tune"),
  viewAnalyse: () => views.show("analyse"),
  viewBatch: () => views.show("batch"),
  viewRecordings: () => views.show("recordings"),
  viewPresets: () => views.show("presets"),
  viewHardware: () => views.show("hardware"),
  showKeys: () => keysDialog.show(),
});

window.vssea = { session, operator, jog, pins, recordings, store: session.store, latest: (name) => session.store.latest(name) };

pins.addEventListener("change", () => side.count("pins", pins.list.length));

session.start();
buildParameters();

/** Hold what a trigger of this page captured; other pages find it among the pinned runs. */
function showCaptured({ by, excerpt }) {
  if (by !== session.you || excerpt.epoch !== session.store.epoch) return;
  stack.timeWindow.follow();
  stack.timeWindow.zoom(excerpt.from_s, excerpt.to_s);
}

async function buildParameters() {
  try {
    const { scenario } = await rest("GET", "/api/schema");
    const schema = new ParameterSchema(scenario);
    batch.take(schema);
    const desk = { session, operator, tryFirst, edits, schema, baseline: new Baseline(session.document) };
    parameters = new ParameterList(document.getElementById("parameters"), desk);
  } catch (refusal) {
    session.note(`The parameters cannot be shown yet: ${refusal.message}`);
    setTimeout(buildParameters, SCHEMA_RETRY_MS);
  }
}
